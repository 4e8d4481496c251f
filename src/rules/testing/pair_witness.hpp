// SPDX-License-Identifier: Apache-2.0
// A box for which all attribute tests of two rules hold.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "rules/language/path_knowledge.hpp"
#include "rules/testing/box_scene.hpp"

namespace cluxel::rules {

/// The first box, of those with simple measures, that lies in all intervals of `name` and passes `accepts`.
std::optional<BoxPrimitive> boxWithin(const PathKnowledge& knowledge, const std::string& name,
                                      const std::function<bool(const perception::Scene&)>& accepts);

/// The box as the `primitives:` of a rule test, in one line.
std::string primitivesText(const BoxPrimitive& box);

}  // namespace cluxel::rules
