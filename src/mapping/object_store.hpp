// SPDX-License-Identifier: Apache-2.0
// The object layer in the map file: objects, parts and their cluxels.
#pragma once

#include <vector>

#include "rdf/file/environment.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

void storeObjects(rdf::WriteTransaction& transaction, const std::vector<rules::SemanticObject>& objects);
std::vector<rules::SemanticObject> storedObjects(const rdf::ReadTransaction& transaction);

}  // namespace cluxel::mapping
