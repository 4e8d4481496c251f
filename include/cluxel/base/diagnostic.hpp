// SPDX-License-Identifier: Apache-2.0
// Faults found in what people wrote or recorded: what is wrong, where, and what to do about it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/base/exit_code.hpp"

namespace cluxel {

/// A place in an input. Lines and columns count from 1 (0: unknown); columns count bytes.
struct SourceLocation {
  std::string file = {};
  std::size_t line = 0;
  std::size_t column = 0;
  std::optional<std::uint64_t> byte_offset = std::nullopt;  ///< for binary files, instead of line and column
};

/// "file:line:col", "file: byte N" or "file", as far as it is known.
std::string toString(const SourceLocation& location);

enum class Severity { Error, Warning };

struct Diagnostic {
  Severity severity = Severity::Error;
  SourceLocation location;
  std::string message;
  std::string hint;         ///< the remedy: "did you mean ...", or empty
  std::string source_line;  ///< the text of the line, to show with a caret; may be empty
};

/// "file:line:col: error: message", then the line, a caret under the column and the hint.
std::string format(const Diagnostic& diagnostic);

/// Errors and warnings of one authored file, one below the other, with a closing count.
std::string format(const std::vector<Diagnostic>& diagnostics);

bool hasErrors(const std::vector<Diagnostic>& diagnostics);

/// Line `line` (from 1) of `text` without its line end; empty when there is none.
std::string_view lineOf(std::string_view text, std::size_t line);

/// The place of byte `offset` in `text`.
SourceLocation locate(std::string file, std::string_view text, std::size_t offset);

/// Any error that reaches a person: its text says what, where and what to do; its code is the program's exit code.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& what) : std::runtime_error(what), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

/// Faulty input at a place, or all the faults of one authored file.
class InputError : public Error {
 public:
  explicit InputError(std::vector<Diagnostic> diagnostics);
  InputError(SourceLocation location, std::string message, std::string hint = {});
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace cluxel
