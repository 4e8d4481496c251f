// SPDX-License-Identifier: Apache-2.0
// Searches in groups of the syntax tree.
#pragma once

#include "sparql/syntax/ast.hpp"

namespace cluxel::sparql {

/// True when the group mentions the variable at any depth.
bool mentions(const ast::GroupPattern& group, ast::VariableIndex variable);
/// True when the group contains a sub-select outside EXISTS.
bool hasSubSelect(const ast::GroupPattern& group);

}  // namespace cluxel::sparql
