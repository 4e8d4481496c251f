// SPDX-License-Identifier: Apache-2.0
// A map file that takes another's place, and writers that must not write into the file that has gone.
#pragma once

#include <chrono>
#include <filesystem>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/knowledge/environment.hpp"

namespace cluxel {

/// Another process is writing to the map.
class MapBusy : public Error {
 public:
  explicit MapBusy(const std::filesystem::path& map);
};

/// The file was replaced or removed since it was opened: what is written into it now would be lost.
class MapReplaced : public Error {
 public:
  explicit MapReplaced(const std::filesystem::path& map);
};

/// A write transaction on the file that has the name `map` now: opened anew when it is replaced while it is waited for.
/// Throws MapBusy when another process has not left it after `patience` (and never before 1.5 s).
WriteTransaction writeMap(const std::filesystem::path& map, std::chrono::milliseconds patience = {});

/// Moves the map `fresh`, which nobody writes to, to the name `map`. When a map is there, the caller holds a write
/// transaction on it; whoever has that one open goes on reading it, and nobody ever opens one with the lock file of the
/// other. There is always a whole map under the name. Throws Error naming both; then `fresh` lies where it was.
void replaceMapFile(const std::filesystem::path& fresh, const std::filesystem::path& map);

}  // namespace cluxel
