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
/// Whether the files that names lead to are read, to find out whether they hold other scans now.
enum class CompareFiles : std::uint8_t { No, Yes };

struct CloudNaming {
  IncludeRetracted include = IncludeRetracted::No;
  CompareFiles compare = CompareFiles::No;
};

/// The clouds that people name by file name ("scan7.pcd"), source path, or at least four leading digits of the id.
/// Throws Error (NotFound, InvalidArgument) for a name that fits none, or several that are there. A name may fit
/// several retracted ones, which are all returned.
/// CompareFiles::Yes: throws Error (InvalidArgument) also for a file that holds another scan of the map now. A file
/// with a scan that the map does not have is noted; one that cannot be read is not looked at. Cost: each name that is
/// the path of a file, and no id, has its whole scan read and hashed, one after the other.
std::vector<scan::ScanId> cloudsNamed(const std::filesystem::path& file, std::span<const std::string> names,
                                      ProgressSink& sink, CloudNaming naming);

}  // namespace cluxel::mapping
