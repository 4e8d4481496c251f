// SPDX-License-Identifier: Apache-2.0
// Which of the truth's classes an object counts as: its own, or the nearest one above it.
#pragma once

#include <string>
#include <vector>

#include "cluxel/reasoning/class_catalogue.hpp"
#include "cluxel/reasoning/semantic_object.hpp"

namespace cluxel {

/// Per object the number of its class among `names` (local names). A class that the truth does not name counts as the
/// nearest of its superclasses that it names (a barrier as a small object), of two equally near ones as the first of
/// `names`; names.size() when there is none.
std::vector<std::size_t> truthClassesOf(const std::vector<SemanticObject>& objects,
                                        const std::vector<std::string>& names, const ClassCatalogue& catalogue);

}  // namespace cluxel
