// SPDX-License-Identifier: Apache-2.0
// What the next run of reasoning reads of the last one, beside the layers of tiles.
#pragma once

#include <vector>

#include "rdf/file/environment.hpp"
#include "rules/objects/known_splits.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

/// Those that operator statements changed, as the rules made them.
void storeObjectsByRules(rdf::WriteTransaction& transaction, const std::vector<rules::SemanticObject>& objects);
std::vector<rules::SemanticObject> storedObjectsByRules(const rdf::ReadTransaction& transaction);
void eraseObjectsByRules(rdf::WriteTransaction& transaction);

/// What this run of reasoning came to about shared crowns, for the next one.
void storeSplits(rdf::WriteTransaction& transaction, const rules::KnownSplits& splits);
/// Knows nothing for a map of a version that had none.
rules::KnownSplits storedSplits(const rdf::ReadTransaction& transaction);

}  // namespace cluxel::mapping
