// SPDX-License-Identifier: Apache-2.0
// The class of the truth that an object counts as: its own, or its nearest superclass.
#pragma once

#include <string>
#include <vector>

#include "rules/decide/semantic_object.hpp"
#include "rules/language/class_catalogue.hpp"

namespace cluxel::tasks {

/// Per object the number of its class among `names` (local names). A class that the truth does not name counts as the
/// nearest of its superclasses that it names (a barrier as a small object), of two equally near ones as the first of
/// `names`; names.size() when there is none.
std::vector<std::size_t> truthClassesOf(const std::vector<rules::SemanticObject>& objects,
                                        const std::vector<std::string>& names, const rules::ClassCatalogue& catalogue);

}  // namespace cluxel::tasks
