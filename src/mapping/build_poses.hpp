// SPDX-License-Identifier: Apache-2.0
// Poses of the scans of a build: mended where that is asked for, else looked at.
#pragma once

#include "cluxel/base/progress.hpp"
#include "cluxel/scan/scan_set.hpp"

namespace cluxel {

/// The same scans with poses that fit each other; what was done is a note. Throws as registerPoses() does.
ScanSet withMendedPoses(const ScanSet& scans, unsigned threads, ProgressSink& sink);

/// Notes poses that do not fit each other: they spoil labels long before anybody sees it in the map. A look at six
/// scans at most; whatever is wrong with the files themselves is left for their reader to say.
void noteDoubtfulPoses(const ScanSet& scans, unsigned threads, ProgressSink& sink);

}  // namespace cluxel
