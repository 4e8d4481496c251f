// SPDX-License-Identifier: Apache-2.0
// The options of all commands that read scans.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

#include "scan/scan_set.hpp"

namespace cluxel::app {

struct ScanOptions {
  std::filesystem::path poses;
  scan::InputFrame frame;

  /// As ScanSet::open() takes them, with the names of the options in its messages.
  scan::ScanSetParams params() const;
};

/// Adds --poses, --units and --up to a command. `options` must outlive it.
void addScanOptions(CLI::App& command, ScanOptions& options);

}  // namespace cluxel::app
