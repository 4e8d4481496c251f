// SPDX-License-Identifier: Apache-2.0
// Forward chaining of the RDFS and OWL rules over an ontology and its facts, to a fixpoint.
#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <unordered_set>

#include "rdf/ontology/closure_bounds.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/ontology/schema.hpp"

namespace cluxel::rdf {

namespace {

struct Pair {
  TermId subject = 0, object = 0;
};

/// The known facts by property: facts of the store are read on demand, derived facts are kept here.
class Facts {
 public:
  Facts(const QuadReader& reader, std::span<const TermId> sources, ClosureBounds& bounds)
      : reader_(reader),
        sources_(sources.begin(), sources.end()),
        lookup_(reader.lookup(QuadOrder::Spog)),
        bounds_(bounds) {
    std::sort(sources_.begin(), sources_.end());
  }

  /// Calls visit(subject, object) for every fact of a property that was stated, or derived before the current round.
  template <typename Visit>
  void forEach(TermId property, const Visit& visit) const {
    forEach(property, kNoTerm, visit);
  }
  /// As above, for those of one object when that is not kNoTerm.
  template <typename Visit>
  void forEach(TermId property, TermId only, const Visit& visit) const {
    if (property == kNoTerm) return;
    QuadCursor cursor = reader_.scan({.s = {}, .p = property, .o = only, .g = {}}, QuadOrder::Posg);
    for (QuadIds quad; cursor.next(quad);) {
      bounds_.addStep(property);
      if (std::binary_search(sources_.begin(), sources_.end(), quad.g)) visit(quad.s, quad.o);
    }
    forEachDerived(property, 0, [&](TermId subject, TermId object) {
      if (only == kNoTerm || object == only) visit(subject, object);
    });
  }

  /// As above, for the facts derived in the previous round.
  template <typename Visit>
  void forEachNew(TermId property, const Visit& visit) const {
    const auto derived = derived_.find(property);
    if (derived != derived_.end()) forEachDerived(property, derived->second.round_before, visit);
  }

  /// Makes stated facts new to the first round.
  void setNew(std::span<const QuadIds> quads) {
    for (const QuadIds& quad : quads) derived_[quad.p].pairs.push_back({quad.s, quad.o});
    for (auto& [property, derived] : derived_) derived.stated = derived.round_start = derived.pairs.size();
  }

  void beginRound() {
    for (auto& [property, derived] : derived_) {
      derived.round_before = derived.round_start;
      derived.round_start = derived.pairs.size();
    }
  }

  /// Returns true when the fact is new.
  bool derive(TermId subject, TermId property, TermId object) {
    bounds_.addStep(property);
    Derived& derived = derived_[property];
    if (derived.known.contains(key(subject, object)) || isStated(subject, property, object)) return false;
    bounds_.addFact(property);
    derived.known.insert(key(subject, object));
    derived.pairs.push_back({subject, object});
    return true;
  }

  std::vector<QuadIds> derivedQuads(TermId graph) const {
    std::vector<QuadIds> quads;
    for (const auto& [property, derived] : derived_)
      for (const Pair& pair : std::span(derived.pairs).subspan(derived.stated))
        quads.push_back({pair.subject, property, pair.object, graph});
    std::sort(quads.begin(), quads.end());
    return quads;
  }

  ClosureBounds& bounds() const { return bounds_; }
  bool isResource(TermId id) const { return reader_.valueOf(id).kind != TermKind::Literal; }

 private:
  struct Derived {
    std::vector<Pair> pairs;                  ///< in derivation order, after those of setNew()
    std::unordered_set<std::uint64_t> known;  ///< for membership tests; never iterated, so its order has no effect
    std::size_t stated = 0, round_before = 0, round_start = 0;
  };

  static std::uint64_t key(TermId subject, TermId object) { return std::uint64_t{subject} << 32U | object; }

  template <typename Visit>
  void forEachDerived(TermId property, std::size_t from, const Visit& visit) const {
    const auto derived = derived_.find(property);
    if (derived == derived_.end()) return;
    for (std::size_t i = from; i < derived->second.round_start; ++i) {
      bounds_.addStep(property);
      const Pair pair = derived->second.pairs[i];  // visit() may append to the list
      visit(pair.subject, pair.object);
    }
  }

  bool isStated(TermId subject, TermId property, TermId object) {
    const std::array<TermId, 3> prefix = {subject, property, object};
    for (auto keys = lookup_.find(prefix); !keys.empty(); keys = lookup_.more())
      for (const QuadKey& stored : keys)
        if (std::binary_search(sources_.begin(), sources_.end(), stored.at(3))) return true;
    return false;
  }

  const QuadReader& reader_;
  std::vector<TermId> sources_;
  PrefixLookup lookup_;
  ClosureBounds& bounds_;
  std::map<TermId, Derived> derived_;
};

Edges edgesOf(const Facts& facts, TermId property) {
  Edges edges;
  facts.forEach(property, [&](TermId subject, TermId object) { edges[subject].insert(object); });
  return edges;
}

/// Semi-naive evaluation: after the first round only new facts are joined, unless the schema has changed.
class Closure {
 public:
  Closure(Facts& facts, const QuadReader& reader, const SchemaWords& words)
      : facts_(facts), reader_(reader), words_(words) {}

  /// `only_new`: the facts without those of Facts::setNew() are closed.
  void run(bool only_new) {
    rules_ = schema();
    while (round(only_new)) {
      facts_.beginRound();
      Schema rules = schema();
      only_new = rules == rules_;
      rules_ = std::move(rules);
    }
  }
  std::vector<std::string> ignored() const { return ignoredAxioms(reader_, rules_); }

 private:
  Schema schema() const {
    const auto scan = [this](TermId property, TermId object, const PairVisit& visit) {
      facts_.forEach(property, object, visit);
    };
    return readSchema(reader_, words_, scan, facts_.bounds());
  }

  bool round(bool only_new) {
    changed_ = false;
    only_new_ = only_new;
    for (const auto& [property, implied] : rules_.implications) applyImplications(property, implied);
    for (const TermId property : rules_.transitive) applyTransitivity(property);
    applyTypes();
    return changed_;
  }

  template <typename Visit>
  void visit(TermId property, const Visit& visitor) const {
    if (only_new_)
      facts_.forEachNew(property, visitor);
    else
      facts_.forEach(property, visitor);
  }

  void applyImplications(TermId property, const std::set<Implied>& implied) {
    visit(property, [&](TermId subject, TermId object) {
      const bool may_invert = facts_.isResource(object);
      for (const Implied& next : implied) {
        if (next.via_inverse && !may_invert) continue;
        changed_ |= next.inverted ? facts_.derive(object, next.property, subject)
                                  : facts_.derive(subject, next.property, object);
      }
    });
  }

  void applyTransitivity(TermId property) {
    bool any = false;
    visit(property, [&](TermId, TermId) { any = true; });
    if (!any) return;
    const Edges edges = edgesOf(facts_, property);
    for (const auto& [node, targets] : edges)
      for (const TermId reached : reachableFrom(node, edges, property, facts_.bounds()))
        // In a cycle of subclasses every class is its own superclass; such trivial facts are not stored.
        if (!targets.contains(reached) && (reached != node || !isSchema(property)))
          changed_ |= facts_.derive(node, property, reached);
  }

  void applyTypes() {
    visit(words_.type, [&](TermId subject, TermId kind) {
      const auto above = rules_.ancestors.find(kind);
      if (above == rules_.ancestors.end()) return;
      for (const TermId ancestor : above->second) changed_ |= facts_.derive(subject, words_.type, ancestor);
    });
  }

  bool isSchema(TermId property) const { return property == words_.sub_class || property == words_.sub_property; }

  Facts& facts_;
  const QuadReader& reader_;
  const SchemaWords& words_;
  Schema rules_;
  bool only_new_ = false;
  bool changed_ = false;
};

}  // namespace

ClosureLimits ClosureLimits::of(const QuadReader& reader) {
  return {5'000'000 + 4 * reader.size(), 200'000'000 + 100 * reader.size(), {}};
}

EntailedQuads closureOf(const QuadReader& reader, TermId target, std::span<const TermId> sources,
                        const ClosureLimits& limits, std::span<const QuadIds> fresh) {
  const SchemaWords words(reader);
  ClosureBounds bounds(reader, limits);
  Facts facts(reader, sources, bounds);
  const bool only_new = !fresh.empty() && std::none_of(fresh.begin(), fresh.end(), [&](const QuadIds& quad) {
    return words.isAxiom(quad.p, quad.o);
  });
  if (only_new) facts.setNew(fresh);
  Closure closure(facts, reader, words);
  closure.run(only_new);
  return {facts.derivedQuads(target), closure.ignored()};
}

}  // namespace cluxel::rdf
