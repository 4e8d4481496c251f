// SPDX-License-Identifier: Apache-2.0
// Questions about what stands in a group of the syntax tree.
#pragma once

#include "cluxel/sparql/ast.hpp"

namespace cluxel::sparql {

/// The variable's name stands anywhere in the group, at any depth.
bool mentions(const ast::GroupPattern& group, ast::VariableIndex variable);
/// A sub-select stands in the group, outside of EXISTS.
bool hasSubSelect(const ast::GroupPattern& group);

}  // namespace cluxel::sparql
