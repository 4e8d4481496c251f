// SPDX-License-Identifier: Apache-2.0
// Writes a manifest that refers to scans in their place and states their poses.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scan/scan_set.hpp"

namespace cluxel::scan {

/// The text of a manifest for `file`: scans in the order given, with path (relative to the manifest's folder), format,
/// time, labels and pose, and the set's frame. Reading it gives the same doubles. `comment` stands above, after '#'.
std::string manifestText(const ScanSet& set, const std::vector<PosedScan>& scans, const std::filesystem::path& file,
                         const std::string& comment);

}  // namespace cluxel::scan
