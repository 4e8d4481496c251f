// SPDX-License-Identifier: Apache-2.0
// The scans that benchmarks of perception run on.
#pragma once

#include <filesystem>
#include <vector>

#include "scan/scan.hpp"

namespace cluxel::bench {

/// The root of the source tree.
std::filesystem::path sourceFolder();

/// The scans of `inputs`; without inputs Oakland 3-D part 2 from the outside data, or a generated campus where that is
/// absent. Prints which.
std::vector<scan::Scan> scansFor(const std::vector<std::filesystem::path>& inputs);

}  // namespace cluxel::bench
