// SPDX-License-Identifier: Apache-2.0
// Commits of what a large batch writes before its scans belong to the map: LMDB holds in memory what a transaction
// writes. Readers see the map as it was.
#pragma once

#include <functional>
#include <span>

#include "cluxel/progress.hpp"
#include "perception/tile.hpp"
#include "rdf/file/environment.hpp"
#include "scan/scan.hpp"

namespace cluxel::mapping {

/// Begins the transaction of a batch, again after each early commit.
using BeginBatch = std::function<rdf::WriteTransaction()>;

/// Commits the points of the `scans` that the transaction has stored, and begins it anew, with these scans. Nothing
/// else may have changed in it.
void commitPoints(std::span<const scan::ScanId> scans, rdf::WriteTransaction& transaction, const BeginBatch& begin);

/// The same after the stages: commits their outputs of `changed` tiles, too, as far as the map did not have the tiles.
/// Does nothing where the map had most of them.
void commitOutputs(std::span<const scan::ScanId> scans, const perception::TileSet& changed,
                   rdf::WriteTransaction& transaction, const BeginBatch& begin);

/// Whether an early commit has been made and its batch has not followed: it was killed, or is not done.
bool hasEarlyCommit(const rdf::ReadTransaction& transaction);
/// Erases what early commits of a killed batch have left.
void eraseEarlyCommit(rdf::WriteTransaction& transaction);
/// The same after an error, which the caller then throws; notes when it cannot be erased now.
void dropEarlyCommit(const BeginBatch& begin, ProgressSink& sink);

}  // namespace cluxel::mapping
