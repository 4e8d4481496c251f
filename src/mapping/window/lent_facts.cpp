// SPDX-License-Identifier: Apache-2.0
// Terms are copied in the order of their ids, so that what lies side by side stays so.
#include "mapping/window/lent_facts.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "mapping/facts/fact_patch.hpp"
#include "mapping/facts/way_facts.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

using rdf::QuadIds;
using rdf::TermId;
namespace vocabulary = rdf::vocabulary;

constexpr std::size_t kQuadsAtOnce = 1'000'000;

/// Adds quads of one map to another.
class QuadCopy {
 public:
  QuadCopy(const rdf::QuadReader& from, rdf::WriteTransaction& into) : from_(from), writer_(into) {}

  void add(std::vector<QuadIds> quads) {
    nameTerms(quads);
    rdf::QuadDifference difference;
    for (const QuadIds& quad : quads)
      difference.added.push_back({named(quad.s), named(quad.p), named(quad.o), named(quad.g)});
    std::sort(difference.added.begin(), difference.added.end());
    writer_.change(difference);
  }

 private:
  TermId named(TermId id) const { return name_[id]; }

  void nameTerms(const std::vector<QuadIds>& quads) {
    std::vector<TermId> terms;
    for (const QuadIds& quad : quads) terms.insert(terms.end(), {quad.s, quad.p, quad.o, quad.g});
    std::sort(terms.begin(), terms.end());
    terms.erase(std::unique(terms.begin(), terms.end()), terms.end());
    if (!terms.empty() && terms.back() >= name_.size()) name_.resize(terms.back() + std::size_t{1}, rdf::kNoTerm);
    for (const TermId term : terms)
      if (name_[term] == rdf::kNoTerm && term != rdf::kNoTerm) name_[term] = writer_.intern(from_.termOf(term));
  }

  const rdf::QuadReader& from_;
  rdf::QuadWriter writer_;
  std::vector<TermId> name_;  ///< by id in the other map
};

}  // namespace

LentFacts::LentFacts(const rdf::ReadTransaction& lender, const NotLent& not_lent)
    : lender_(lender),
      graph_(idOf(std::string(vocabulary::kGraphObserved))),
      root_(idOf(rdf::iriOfMapRoot())),
      has_cloud_(idOf(vocabulary::clx("hasCloud"))),
      has_primitive_(idOf(vocabulary::clx("hasPrimitive"))),
      touches_ground_(idOf(vocabulary::clx("touchesGround"))) {
  for (const ContentHash& object : not_lent.objects) leaveOut(object, objects_);
  for (const ContentHash& object : not_lent.wide) leaveOut(object, of_wide_);
  for (const ContentHash& primitive : not_lent.primitives) primitives_.insert(idOf(rdf::iriOfPrimitive(primitive)));
}

rdf::TermId LentFacts::idOf(const std::string& iri) const {
  return lender_.idOf(Term::iri(iri)).value_or(rdf::kNoTerm);
}

void LentFacts::leaveOut(const ContentHash& object, Ids& subjects) const {
  const TermId id = idOf(rdf::iriOfObject(object));
  if (id == rdf::kNoTerm) return;  // in a pattern it would stand for any
  const std::vector<TermId> of_object = subjectsOfObject(lender_, graph_, id);
  subjects.insert(of_object.begin(), of_object.end());
}

bool LentFacts::isOfWay(TermId subject) {
  if (subject == subject_) return subject_is_of_way_;
  const std::string_view text = lender_.viewOf(subject).text;
  constexpr std::array kKinds{WayKind::Region, WayKind::Junction, WayKind::Way, WayKind::Kerb};
  subject_ = subject;
  subject_is_of_way_ =
      std::any_of(kKinds.begin(), kKinds.end(), [&](WayKind kind) { return text.starts_with(iriOfWays(kind)); });
  return subject_is_of_way_;
}

/// A primitive that is told anew may be named by others: where that changes, these are told anew, too.
bool LentFacts::isLent(const QuadIds& quad) {
  if (quad.s == root_) return quad.p == has_cloud_;
  if (objects_.contains(quad.s) || objects_.contains(quad.o)) return false;
  if (primitives_.contains(quad.s)) {
    if (quad.p == touches_ground_) touched_patches_.insert(lender_.termOf(quad.o).text);
    return false;
  }
  if (of_wide_.contains(quad.s)) return quad.p == has_primitive_ && !primitives_.contains(quad.o);
  return !isOfWay(quad.s);
}

std::set<std::string> LentFacts::add(rdf::WriteTransaction& into) {
  QuadCopy copy(lender_, into);
  std::vector<QuadIds> quads;
  rdf::QuadCursor cursor = lender_.scan({.s = {}, .p = {}, .o = {}, .g = graph_}, rdf::QuadOrder::Gspo);
  for (QuadIds quad; cursor.next(quad);) {
    if (isLent(quad)) quads.push_back(quad);
    if (quads.size() == kQuadsAtOnce) copy.add(std::exchange(quads, {}));
  }
  copy.add(std::move(quads));
  return std::move(touched_patches_);
}

}  // namespace cluxel::mapping
