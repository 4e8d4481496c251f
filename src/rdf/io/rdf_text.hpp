// SPDX-License-Identifier: Apache-2.0
// The text of a source in pieces, so that a file need not fit into memory.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "rdf/io/rdf_io.hpp"

namespace cluxel::rdf {

/// Some lines of a source, with their ends.
struct RdfPiece {
  std::string_view text;
  std::uint64_t first_line = 1;
};

class RdfText {
 public:
  explicit RdfText(const RdfSource& source) : source_(source) {}

  /// Visits the text from its begin until `visit` returns false. A piece has some 256 KiB, or one line when that is
  /// longer. A byte order mark is left out, except in XML.
  void forEachPiece(const std::function<bool(const RdfPiece&)>& visit) const;
  /// A hash of the text, its base IRI and its graph: 12 hexadecimal digits.
  std::string hash() const;
  /// Line `number` (from 1), as it is shown in messages. Reads the file again.
  std::string line(std::uint64_t number) const;

 private:
  void forEachPieceOfFile(const std::function<bool(const RdfPiece&)>& visit) const;

  const RdfSource& source_;
};

}  // namespace cluxel::rdf
