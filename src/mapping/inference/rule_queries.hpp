// SPDX-License-Identifier: Apache-2.0
// Queries for the solutions of a SPARQL rule, as a whole or for some values of a variable.
#pragma once

#include <optional>
#include <vector>

#include "mapping/inference/rule_shape.hpp"

namespace cluxel::mapping {

/// Some values of a variable.
struct ValuesOf {
  ast::VariableIndex variable = 0;
  std::vector<Term> terms;
};

/// SELECT of the variables that the template needs; ByKey: after the key. `keys`: only solutions with one of these.
/// `all`: with all variables of the patterns of a plain rule.
ast::Query solutionsOf(const RuleShape& shape, const std::optional<ValuesOf>& keys, bool all);
/// SELECT of the keys of solutions in which a variable may have one of the values: a superset of them.
ast::Query keysOf(const RuleShape& shape, const ValuesOf& values);

}  // namespace cluxel::mapping
