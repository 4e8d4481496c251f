// SPDX-License-Identifier: Apache-2.0
// Collects raptor's error messages as diagnostics.
#pragma once

#include <string>
#include <vector>

#include "cluxel/error.hpp"
#include "rdf/io/rdf_text.hpp"

namespace cluxel::rdf {

/// Keeps the first message of each line; later ones are usually consequences of it.
class RdfFaults {
 public:
  explicit RdfFaults(const RdfSource& source) : source_(source), text_(source) {}
  /// The piece that the parser reads: most messages are about its lines.
  void enter(const RdfPiece& piece) { piece_ = piece; }
  /// `line` and `column` start at 1; 0 when raptor does not report them.
  void add(std::size_t line, std::size_t column, std::string_view message);
  void throwIfAny() const;

 private:
  std::string lineNumbered(std::size_t line) const;

  const RdfSource& source_;
  RdfText text_;
  RdfPiece piece_;
  std::vector<Diagnostic> diagnostics_;
  std::string without_place_;  ///< a message whose location comes with the next one
};

}  // namespace cluxel::rdf
