// SPDX-License-Identifier: Apache-2.0
// The object layer in the map file: objects, parts and their cluxels.
#pragma once

#include <cstdint>
#include <vector>

#include "rdf/file/environment.hpp"
#include "rules/objects/known_splits.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

void storeObjects(rdf::WriteTransaction& transaction, const std::vector<rules::SemanticObject>& objects);
std::vector<rules::SemanticObject> storedObjects(const rdf::ReadTransaction& transaction);

/// Those that operator statements changed, as the rules made them.
void storeObjectsByRules(rdf::WriteTransaction& transaction, const std::vector<rules::SemanticObject>& objects);
std::vector<rules::SemanticObject> storedObjectsByRules(const rdf::ReadTransaction& transaction);
void eraseObjectsByRules(rdf::WriteTransaction& transaction);

/// Digests of what was decided about each primitive, in the order of the scene's primitives
/// (rules::decisionDigests()).
void storeDigests(rdf::WriteTransaction& transaction, const std::vector<std::uint64_t>& digests);
/// Empty for a map of a version that had none.
std::vector<std::uint64_t> storedDigests(const rdf::ReadTransaction& transaction);

/// What this run of reasoning came to about shared crowns, for the next one.
void storeSplits(rdf::WriteTransaction& transaction, const rules::KnownSplits& splits);
/// Knows nothing for a map of a version that had none.
rules::KnownSplits storedSplits(const rdf::ReadTransaction& transaction);

}  // namespace cluxel::mapping
