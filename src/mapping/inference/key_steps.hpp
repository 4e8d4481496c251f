// SPDX-License-Identifier: Apache-2.0
// How the patterns of a rule lead from a value of a variable to the keys of the solutions that have it.
#pragma once

#include <map>
#include <vector>

#include "mapping/inference/rule_shape.hpp"

namespace cluxel::mapping {

/// From a value of a variable at one end of a pattern to the values at its other end.
struct KeyStep {
  std::size_t read = 0;     ///< number in RuleShape::reads
  bool to_subject = false;  ///< the value is the object
  ast::VariableIndex to = 0;
};

/// For variables that patterns join with the key: steps of which each solution can take one, to variables that are the
/// key or have steps themselves. Those that patterns join only with a variable that has a constant object, such as a
/// type, lead to this one. No chain of steps comes back to its start.
std::map<ast::VariableIndex, std::vector<KeyStep>> stepsToKey(const RuleShape& shape);

}  // namespace cluxel::mapping
