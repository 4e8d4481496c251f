// SPDX-License-Identifier: Apache-2.0
// Patterns as ids.
#include "mapping/inference/read_test.hpp"

#include <algorithm>

namespace cluxel::mapping {

namespace {

std::optional<rdf::TermId> idOf(const rdf::QuadReader& reader, const ast::PatternTerm& part) {
  return part.isVariable() ? std::optional<rdf::TermId>(rdf::kNoTerm) : reader.idOf(part.term());
}

bool fits(rdf::TermId wanted, rdf::TermId id) {
  return wanted == rdf::kNoTerm || wanted == id;
}

bool fits(const rdf::Triple& pattern, const rdf::Triple& fact) {
  return fits(pattern.p, fact.p) && fits(pattern.o, fact.o) && fits(pattern.s, fact.s);
}

}  // namespace

ReadTest::ReadTest(const rdf::QuadReader& reader, const RuleShape& shape) {
  for (const ReadPattern& read : shape.reads) {
    std::vector<rdf::Triple>& ids = patterns_.emplace_back();
    for (const Term& link : read.links)
      if (const auto id = reader.idOf(link)) ids.push_back({rdf::kNoTerm, *id, rdf::kNoTerm});
    if (read.triple.isPath()) continue;
    const auto s = idOf(reader, read.triple.subject), p = idOf(reader, read.triple.predicate),
               o = idOf(reader, read.triple.object);
    if (s && p && o) ids.push_back({*s, *p, *o});
  }
  for (const auto& ids : patterns_)
    for (const rdf::Triple& pattern : ids) properties_.insert(pattern.p);
}

bool ReadTest::matches(std::size_t read, const rdf::Triple& fact) const {
  const auto& ids = patterns_[read];
  return std::any_of(ids.begin(), ids.end(), [&](const rdf::Triple& pattern) { return fits(pattern, fact); });
}

bool ReadTest::matches(const rdf::Triple& fact) const {
  for (std::size_t read = 0; read < patterns_.size(); ++read)
    if (matches(read, fact)) return true;
  return false;
}

std::optional<rdf::Triple> ReadTest::patternOf(std::size_t read) const {
  return patterns_[read].empty() ? std::nullopt : std::optional(patterns_[read].front());
}

std::vector<rdf::TermId> ReadTest::linksOf(std::size_t read) const {
  std::vector<rdf::TermId> links;
  for (const rdf::Triple& pattern : patterns_[read]) links.push_back(pattern.p);
  return links;
}

}  // namespace cluxel::mapping
