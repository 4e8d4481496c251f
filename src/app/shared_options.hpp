// SPDX-License-Identifier: Apache-2.0
// Options that several commands have: how scans are read, and the limits of a query.
#pragma once

#include <cstdint>

#include "app/command.hpp"
#include "scan/scan_set.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::app {

struct ScanOptions {
  fs::path poses;
  scan::InputFrame frame;

  /// As ScanSet::open() takes them, with the names of the options in its messages.
  scan::ScanSetParams params() const;
};

/// Adds --poses, --units and --up to a command. `options` must outlive it.
void addScanOptions(CLI::App& command, ScanOptions& options);

struct BudgetOptions {
  double deadline_s = 0;  ///< 0: none
  std::uint64_t max_memory_mib = 0;

  void applyTo(sparql::QueryBudget& budget) const;
};

/// Adds --deadline and --max-memory to a command. `options` must outlive it.
void addBudget(CLI::App& command, BudgetOptions& options);

/// Adds --author: who makes statements.
void addAuthor(CLI::App& command, std::string& author);
/// The given author, or else the user's name, if it is known.
std::string authorOr(const std::string& given);

/// Adds --html: a file for figures beside what the command prints.
void addHtmlFile(CLI::App& command, fs::path& file);

/// Throws Error (StoreUnavailable) when `output` is a map.
void refuseToReplaceMap(const fs::path& output);
/// Writes a file that a command makes, unless that would replace a map. Errors as for these two functions.
void writeOutput(const fs::path& output, std::string_view bytes);

}  // namespace cluxel::app
