// SPDX-License-Identifier: Apache-2.0
// Poses of the scans of a build: refined on request, otherwise checked.
#pragma once

#include "cluxel/progress.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::mapping {

/// The same scans with poses refined by registration; a note to `sink` summarises the result. Throws as registerPoses()
/// does.
scan::ScanSet withRefinedPoses(const scan::ScanSet& scans, unsigned threads, ProgressSink& sink);

/// Notes poses that do not fit each other, because they degrade labels: surfaces of scans that lie apart. Asks about
/// scans near each other, at the same heights, that no measured pairs join: a pose may be wrong, or a wall lies between
/// them. Checks a sample of at most six scans, and notes when that fails. Unreadable files are not reported here but
/// when they are loaded.
void noteDoubtfulPoses(const scan::ScanSet& scans, unsigned threads, ProgressSink& sink);

}  // namespace cluxel::mapping
