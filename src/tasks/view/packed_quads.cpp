// SPDX-License-Identifier: Apache-2.0
// Numbers the terms by their text, so that neither arrival order nor term ids show.
#include "tasks/view/packed_quads.hpp"

#include <algorithm>
#include <array>
#include <tuple>

#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::tasks {

namespace {

void appendNumber(std::uint64_t value, std::string& bytes) {
  for (; value >= 0x80U; value >>= 7U) bytes.push_back(static_cast<char>((value & 0x7fU) | 0x80U));
  bytes.push_back(static_cast<char>(value));
}

std::vector<rdf::QuadIds> currentQuads(const rdf::QuadReader& reader) {
  const auto history = reader.idOf(Term::iri(rdf::vocabulary::kGraphHistory));
  std::vector<rdf::QuadIds> quads;
  rdf::QuadCursor cursor = reader.scan({}, rdf::QuadOrder::Gspo);
  for (rdf::QuadIds quad; cursor.next(quad);)
    if (!history || quad.g != *history) quads.push_back(quad);
  return quads;
}

/// Removes the quads whose subject is a primitive; returns their number.
std::uint64_t removePrimitives(const rdf::QuadReader& reader, std::vector<rdf::QuadIds>& quads) {
  const std::string prefix = rdf::mapIri("primitive", "");
  return std::erase_if(quads, [&](const rdf::QuadIds& quad) { return reader.viewOf(quad.s).text.starts_with(prefix); });
}

/// The numbers of the terms that occur, by id, and the terms' lines.
class TermNumbers {
 public:
  TermNumbers(const rdf::QuadReader& reader, const std::vector<rdf::QuadIds>& quads) : number_(reader.termCount() + 1) {
    std::vector<rdf::TermId> ids;
    for (const rdf::QuadIds& quad : quads)
      for (const rdf::TermId id : {quad.s, quad.p, quad.o, quad.g}) {
        if (id >= number_.size()) number_.resize(id + 1);
        if (number_[id]++ == 0) ids.push_back(id);
      }
    std::vector<std::pair<std::string, rdf::TermId>> lines;
    lines.reserve(ids.size());
    for (const rdf::TermId id : ids)
      lines.emplace_back(id == rdf::kNoTerm ? std::string() : toNTriples(reader.termOf(id)), id);
    std::sort(lines.begin(), lines.end());
    for (std::size_t i = 0; i < lines.size(); ++i) {
      number_[lines[i].second] = static_cast<std::uint32_t>(i);
      text_ += lines[i].first + "\n";
    }
  }

  std::uint32_t operator[](rdf::TermId id) const { return number_[id]; }
  std::string takeText() { return std::move(text_); }

 private:
  std::vector<std::uint32_t> number_;
  std::string text_;
};

}  // namespace

PackedQuads packedQuadsOf(const rdf::QuadReader& reader, std::uint64_t max_quads) {
  std::vector<rdf::QuadIds> quads = currentQuads(reader);
  PackedQuads packed;
  if (quads.size() > max_quads) packed.left_out = removePrimitives(reader, quads);
  TermNumbers number(reader, quads);
  std::vector<std::array<std::uint32_t, 4>> rows;
  rows.reserve(quads.size());
  for (const rdf::QuadIds& quad : quads)
    rows.push_back({number[quad.g], number[quad.s], number[quad.p], number[quad.o]});
  std::sort(rows.begin(), rows.end());
  packed.quad_count = rows.size();
  for (std::size_t i = 0, end = 0; i < rows.size(); i = end) {
    while (end < rows.size() && rows[end][0] == rows[i][0]) ++end;
    appendNumber(rows[i][0], packed.quads);
    appendNumber(end - i, packed.quads);
    std::uint32_t subject = 0;
    for (std::size_t k = i; k < end; ++k) {
      appendNumber(rows[k][1] - subject, packed.quads);
      appendNumber(rows[k][2], packed.quads);
      appendNumber(rows[k][3], packed.quads);
      subject = rows[k][1];
    }
  }
  packed.terms = number.takeText();
  return packed;
}

}  // namespace cluxel::tasks
