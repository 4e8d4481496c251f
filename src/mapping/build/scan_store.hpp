// SPDX-License-Identifier: Apache-2.0
// The cloud layer: scans with points and poses in the map file, cut into segments per tile.
#pragma once

#include <optional>
#include <vector>

#include "mapping/cloud.hpp"
#include "perception/tile.hpp"
#include "rdf/file/environment.hpp"
#include "scan/scan.hpp"

namespace cluxel::mapping {

using TileSet = perception::TileSet;

/// Stores a scan and its segments; returns the tiles it touches. A scan that was measured alike and has the same pose
/// is the same cloud: nothing is stored but the later of the two times (a time is later than none). The same scan with
/// another pose, or with a pose where there was none, is an InputError.
TileSet storeScan(rdf::WriteTransaction& transaction, const scan::Scan& scan);

/// Removes a scan with its segments; returns the tiles it touched. Throws Error (NotFound) when there is none.
TileSet removeScan(rdf::WriteTransaction& transaction, const scan::ScanId& id);

/// A stored scan as it was given. Throws Error (NotFound) when there is none.
scan::Scan storedScan(const rdf::ReadTransaction& transaction, const scan::ScanId& id);

/// All tiles that hold points of some scan.
TileSet storedTiles(const rdf::ReadTransaction& transaction);

/// The clouds of the map, ascending by id.
std::vector<Cloud> storedClouds(const rdf::ReadTransaction& transaction);
std::optional<Cloud> storedCloud(const rdf::ReadTransaction& transaction, const scan::ScanId& id);
/// Points of a cloud as they were given.
scan::ScanPoints storedPoints(const rdf::ReadTransaction& transaction, const scan::ScanId& id);

}  // namespace cluxel::mapping
