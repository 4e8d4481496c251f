// SPDX-License-Identifier: Apache-2.0
// What reasoning tests share: the outdoor classes as a plain catalogue, and rule texts loaded from strings.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "rules/language/rule_loader.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;

/// IRI of a class in Cluxel's ontology.
std::string clx(const std::string& name);

/// The concepts of the outdoor ontology that the shipped rules name.
ClassCatalogue outdoorCatalogue();

/// Loads `text` as rules.yaml.
LoadedRules loadText(const std::string& text, const ClassCatalogue& catalogue = outdoorCatalogue());

/// The rules of `body` (below `rules:`) for the classes in `order`; the test fails when there is a fault.
RuleSet rulesOf(const std::string& order, const std::string& body);

}  // namespace cluxel::testing
