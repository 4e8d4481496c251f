// SPDX-License-Identifier: Apache-2.0
// The object layer in the map file: objects, parts and their cluxels.
#pragma once

#include <vector>

#include "cluxel/knowledge/environment.hpp"
#include "cluxel/reasoning/semantic_object.hpp"

namespace cluxel {

void storeObjects(WriteTransaction& transaction, const std::vector<SemanticObject>& objects);
std::vector<SemanticObject> storedObjects(const ReadTransaction& transaction);

}  // namespace cluxel
