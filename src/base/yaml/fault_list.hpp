// SPDX-License-Identifier: Apache-2.0
// Collects all faults of authored files, each with its place and the line it stands in.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "cluxel/error.hpp"

namespace cluxel {

/// The faults found so far in one or more files. The first kMaxFaults errors (base/shown_line.hpp), and as many
/// warnings, are kept; the rest are only counted.
class FaultList {
 public:
  FaultList() = default;
  FaultList(std::string file, std::string text) { addFile(std::move(file), std::move(text)); }

  /// Makes the lines of `file` known, so that later faults can show them. The order of these calls is the order of the
  /// files in sorted().
  void addFile(std::string file, std::string text);
  void error(const SourceLocation& at, std::string message, std::string hint = {});
  void warning(const SourceLocation& at, std::string message, std::string hint = {});

  std::size_t errorCount() const { return errors_; }
  /// By file, line and column; equal faults at one place once.
  std::vector<Diagnostic> sorted() const;
  /// Throws InputError with all faults when there is an error.
  void throwIfErrors() const;

 private:
  void add(Severity severity, const SourceLocation& at, std::string message, std::string hint);

  std::vector<std::pair<std::string, std::string>> files_;
  std::vector<Diagnostic> faults_;
  std::size_t errors_ = 0, warnings_ = 0;
};

}  // namespace cluxel
