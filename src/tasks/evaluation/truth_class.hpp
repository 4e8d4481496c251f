// SPDX-License-Identifier: Apache-2.0
// The class of the truth that an object counts as: its own, or its nearest superclass.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "rules/language/class_catalogue.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::tasks {

/// The classes of a truth, by local names as rdf::ClassNames gives them, and what answers of other classes count as.
struct TruthClasses {
  std::vector<std::string> names;
  std::map<std::string, std::string> counts_as = {};  ///< to one of `names`; goes before the class's own name
  std::set<std::string> meant = {};                   ///< those of `names` that some label or truth file can mean
};

/// Per object the number of its class among the truth's. A class counts as what `counts_as` says, else as itself. When
/// the truth says neither, the same is asked of its superclasses, the nearest first (a barrier counts as a small
/// object); of two equally near ones the first of `names` is taken. The number of names when there is none.
std::vector<std::size_t> truthClassesOf(const std::vector<rules::SemanticObject>& objects, const TruthClasses& truth,
                                        const rules::ClassCatalogue& catalogue);

}  // namespace cluxel::tasks
