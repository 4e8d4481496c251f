// SPDX-License-Identifier: Apache-2.0
// Clouds of a map by the names that people give them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "cluxel/progress.hpp"
#include "scan/scan.hpp"

namespace cluxel::mapping {

/// Whether a name may mean a retracted scan when it fits no scan of the map.
enum class IncludeRetracted : std::uint8_t { No, Yes };

/// The clouds that people name by file name ("scan7.pcd"), source path, or at least four leading digits of the id.
/// Throws Error (NotFound, InvalidArgument) for a name that fits none, or several that are there, and for a file that
/// holds another scan of the map now. A file with a scan that the map does not have is noted; one that cannot be read
/// is not looked at. A name may fit several retracted ones, which are all returned.
std::vector<scan::ScanId> cloudsNamed(const std::filesystem::path& file, std::span<const std::string> names,
                                      ProgressSink& sink, IncludeRetracted include = IncludeRetracted::No);

}  // namespace cluxel::mapping
