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

/// Calls `visit` for all quads but history.
template <typename Visit>
void forEachCurrent(const rdf::QuadReader& reader, const Visit& visit) {
  const auto history = reader.idOf(Term::iri(rdf::vocabulary::kGraphHistory));
  rdf::QuadCursor cursor = reader.scan({}, rdf::QuadOrder::Gspo);
  for (rdf::QuadIds quad; cursor.next(quad);)
    if (!history || quad.g != *history) visit(quad);
}

/// Tells the quads about primitives. Those of a subject mostly follow each other.
class PrimitiveSubjects {
 public:
  explicit PrimitiveSubjects(const rdf::QuadReader& reader) : reader_(reader), prefix_(rdf::mapIri("primitive", "")) {}

  bool hold(rdf::TermId subject) {
    if (subject != last_) is_primitive_ = reader_.viewOf(subject).text.starts_with(prefix_);
    last_ = subject;
    return is_primitive_;
  }

 private:
  const rdf::QuadReader& reader_;
  std::string prefix_;
  rdf::TermId last_ = rdf::kNoTerm;
  bool is_primitive_ = false;
};

struct ShownQuads {
  std::vector<rdf::QuadIds> quads;
  std::uint64_t left_out = 0;
};

/// Quads that are left out are never held: they grow with the map.
ShownQuads shownQuads(const rdf::QuadReader& reader, std::uint64_t max_quads) {
  std::uint64_t count = 0;
  forEachCurrent(reader, [&count](const rdf::QuadIds&) { ++count; });
  ShownQuads shown;
  PrimitiveSubjects primitives(reader);
  forEachCurrent(reader, [&](const rdf::QuadIds& quad) {
    if (count <= max_quads || !primitives.hold(quad.s)) shown.quads.push_back(quad);
  });
  shown.left_out = count - shown.quads.size();
  return shown;
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
  const auto [quads, left_out] = shownQuads(reader, max_quads);
  PackedQuads packed;
  packed.left_out = left_out;
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
