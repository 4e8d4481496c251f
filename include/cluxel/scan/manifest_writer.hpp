// SPDX-License-Identifier: Apache-2.0
// A manifest of scans that lie where they lie, with poses of its own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cluxel/scan/scan_set.hpp"

namespace cluxel {

/// The text of a manifest for `file`: scans in the order given, with path (relative to the manifest's folder), format,
/// time, labels and pose, and the set's frame. Reading it gives the same doubles. `comment` stands above, after '#'.
std::string manifestText(const ScanSet& set, const std::vector<PosedScan>& scans, const std::filesystem::path& file,
                         const std::string& comment);

}  // namespace cluxel
