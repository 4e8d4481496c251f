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

#include "cluxel/export.hpp"

namespace cluxel {

/// A place in an input. Lines and columns count from 1 (0: unknown); columns count bytes.
struct SourceLocation {
  std::string file = {};
  std::size_t line = 0;
  std::size_t column = 0;
  std::optional<std::uint64_t> byte_offset = std::nullopt;  ///< for binary files, instead of line and column
};

/// "file:line:col", "file: byte N" or "file", as far as it is known.
CLUXEL_API std::string toString(const SourceLocation& location);

enum class Severity { Error, Warning };

struct Diagnostic {
  Severity severity = Severity::Error;
  SourceLocation location;
  std::string message;
  std::string hint;         ///< the remedy: "did you mean ...", or empty
  std::string source_line;  ///< the text of the line, to show with a caret; may be empty
};

/// "file:line:col: error: message", then the line, a caret under the column and the hint.
CLUXEL_API std::string format(const Diagnostic& diagnostic);

/// Errors and warnings of one authored file, one below the other, with a closing count.
CLUXEL_API std::string format(const std::vector<Diagnostic>& diagnostics);

CLUXEL_API bool hasErrors(const std::vector<Diagnostic>& diagnostics);

/// Line `line` (from 1) of `text` without its line end; empty when there is none.
CLUXEL_API std::string_view lineOf(std::string_view text, std::size_t line);

/// The place of byte `offset` in `text`.
CLUXEL_API SourceLocation locate(std::string file, std::string_view text, std::size_t offset);

/// What kind of thing went wrong. A program maps it to its exit code or status.
enum class ErrorKind : std::uint8_t {
  InvalidArgument,   ///< an option, name or combination of options is not allowed
  NotFound,          ///< nothing has the name that was asked for
  FaultyInput,       ///< unreadable scans, faulty query, update, RDF, rules, ontology, labels or model
  StoreUnavailable,  ///< the map cannot be opened, locked, read or written
  BudgetExceeded,    ///< a deadline, row or memory budget ran out
};

/// What the caller can do about an error, where one setting of the call helps. A program names its option for it.
enum class Remedy : std::uint8_t {
  None,
  ReplaceMap,      ///< replace it: BuildOptions::force, MergeOptions::force
  NameHome,        ///< name the folder that holds ontology, rules, queries, models and labels
  NamePoses,       ///< name the file of poses
  NameTruth,       ///< name a folder of truth files
  ListClouds,      ///< list the clouds of the map
  NameService,     ///< name the store that answers SERVICE
  NameLoadFile,    ///< name the file that LOAD reads
  NameValue,       ///< give a parameter of a question as NAME=VALUE
  LocalFrame,      ///< export in metres of the map frame
  NameTransform,   ///< name the transform from the second map to the first
  ChooseInputs,    ///< choose the map whose ontology, rules and model a merge uses
  MoveScans,       ///< give scans of the map other poses
  MergeMaps,       ///< merge maps instead of adding scans
  DropStatements,  ///< let operator statements go: MergeOptions::drop_statements
  NameStart,       ///< name the place where a walk starts
  NameTime,        ///< tell from when on scans count as later
};

/// Base of all errors of the library. what() says what is wrong, where, and what to do. A NUL character in it, where
/// readers of what() would stop, becomes \0.
class CLUXEL_API Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& what, Remedy remedy = Remedy::None);
  ErrorKind kind() const { return kind_; }
  Remedy remedy() const { return remedy_; }

 private:
  ErrorKind kind_;
  Remedy remedy_;
};

/// Faulty input at a place, or all the faults of one authored file.
class CLUXEL_API InputError : public Error {
 public:
  explicit InputError(std::vector<Diagnostic> diagnostics);
  InputError(std::vector<Diagnostic> diagnostics, Remedy remedy);
  InputError(SourceLocation location, std::string message, std::string hint = {});
  InputError(SourceLocation location, std::string message, std::string hint, Remedy remedy);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace cluxel
