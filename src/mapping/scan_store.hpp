// SPDX-License-Identifier: Apache-2.0
// The cloud layer: scans with their points and poses in the map file, cut into segments per tile.
#pragma once

#include <optional>
#include <vector>

#include "cluxel/knowledge/environment.hpp"
#include "cluxel/mapping/cloud.hpp"
#include "cluxel/scan/scan.hpp"
#include "mapping/stage_outputs.hpp"

namespace cluxel {

/// Stores a scan and its segments; the tiles that it touches are returned. Nothing happens when the same scan with the
/// same pose is there already; with another pose, or with one where there was none, it is an InputError.
TileSet storeScan(WriteTransaction& transaction, const Scan& scan);

/// All tiles that hold points of some scan.
TileSet storedTiles(const ReadTransaction& transaction);

/// The clouds of the map, ascending by id.
std::vector<Cloud> storedClouds(const ReadTransaction& transaction);
std::optional<Cloud> storedCloud(const ReadTransaction& transaction, const ScanId& id);
/// Points of a cloud as they were given.
ScanPoints storedPoints(const ReadTransaction& transaction, const ScanId& id);

}  // namespace cluxel
