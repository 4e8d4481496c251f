// SPDX-License-Identifier: Apache-2.0
// The file that a merge replaces: what it may be, what must not be lost with it, and the replacement.
#pragma once

#include <filesystem>
#include <vector>

#include "cluxel/progress.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// Throws Error (StoreUnavailable) for a folder and for a file that is neither empty nor a map.
void requireMapOrNothing(const std::filesystem::path& target);

/// Throws Error (InvalidArgument) when `target` is a map with operator statements, or withdrawals of them, that a merge
/// of `maps` would not have. Statements that one of the maps has withdrawn since are not missed.
void requireStatementsKept(const std::filesystem::path& target, const std::vector<const rdf::QuadReader*>& maps);

/// Moves the map `merged` to `target`, which may be a map. With `drop_statements`, notes that operator statements are
/// dropped; else refuses it as requireStatementsKept(): an update may have come since the merge began. Waits up to 10
/// minutes, and notes it, while another process writes, copies or opens the target; then throws rdf::MapBusy.
void replaceByMerged(const std::filesystem::path& merged, const std::filesystem::path& target, bool drop_statements,
                     ProgressSink& sink);

}  // namespace cluxel::mapping
