// SPDX-License-Identifier: Apache-2.0
// What the next run of reasoning over the whole map reads of the last one.
#pragma once

#include "rdf/file/environment.hpp"
#include "rules/objects/known_splits.hpp"

namespace cluxel::mapping {

/// What this run of reasoning came to about shared crowns, for the next one.
void storeSplits(rdf::WriteTransaction& transaction, const rules::KnownSplits& splits);
/// Adds what another map knows.
void copySplits(rdf::WriteTransaction& transaction, const rdf::ReadTransaction& other);
/// Knows nothing for a map of a version that had none.
rules::KnownSplits storedSplits(const rdf::ReadTransaction& transaction);
/// For a run over a part of the map: the same, but nothing where the map knows so many that reading them takes longer
/// than they save.
rules::KnownSplits storedSplitsIfFew(const rdf::ReadTransaction& transaction);

}  // namespace cluxel::mapping
