// SPDX-License-Identifier: Apache-2.0
// Forward chaining of the RDFS and OWL rules over an ontology and its facts, to a fixpoint.
#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "base/radix_order.hpp"
#include "rdf/ontology/closure_bounds.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/ontology/schema.hpp"

namespace cluxel::rdf {

namespace {

struct Pair {
  TermId subject = 0, object = 0;
};

/// The known facts by property: facts of the store are read on demand, derived facts are kept here. What a round
/// derives is collected, and compared with what is known when the round ends: sorted lists are quicker than single
/// look-ups.
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
      if (isSource(quad.g)) visit(quad.s, quad.o);
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

  /// Ends a round; true when it has derived new facts. The next round sees them.
  bool endRound() {
    bool any = false;
    for (auto& [property, derived] : derived_) {
      settle(property, derived);
      derived.round_before = derived.round_start;
      derived.round_start = derived.pairs.size();
      any = any || derived.round_start != derived.round_before;
    }
    return any;
  }

  void derive(TermId subject, TermId property, TermId object) {
    bounds_.addStep(property);
    Derived& derived = derived_[property];
    derived.offered.push_back(key(subject, object));
    if (derived.offered.size() > kMaxOffered + 2 * derived.known.size()) settle(property, derived);
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
    std::vector<Pair> pairs;             ///< in derivation order, after those of setNew()
    std::vector<std::uint64_t> known;    ///< keys of derived pairs, ascending
    std::vector<std::uint64_t> offered;  ///< keys of pairs that were derived since, some of them known or stated
    std::size_t stated = 0, round_before = 0, round_start = 0;
  };

  /// More offered pairs than this, and than twice the known ones, are not collected: they are settled within the round.
  static constexpr std::size_t kMaxOffered = std::size_t{1} << 16U;
  /// From so many pairs on all stated facts of the property are read in their order, instead of a search for each.
  static constexpr std::size_t kManyPairs = 1024;

  /// Ascending keys are in the order of index posg.
  static std::uint64_t key(TermId subject, TermId object) { return std::uint64_t{object} << 32U | subject; }
  static Pair pairOf(std::uint64_t key) { return {static_cast<TermId>(key), static_cast<TermId>(key >> 32U)}; }

  /// Moves those of the offered pairs that are new to the derived ones.
  void settle(TermId property, Derived& derived) {
    std::vector<std::uint64_t> fresh = std::exchange(derived.offered, {});
    if (fresh.empty()) return;
    sortNumbers(fresh);
    fresh.erase(std::unique(fresh.begin(), fresh.end()), fresh.end());
    if (!derived.known.empty())
      std::erase_if(fresh, [&](std::uint64_t pair) {
        return std::binary_search(derived.known.begin(), derived.known.end(), pair);
      });
    eraseStated(property, fresh);
    for (const std::uint64_t pair : fresh) {
      bounds_.addFact(property);
      derived.pairs.push_back(pairOf(pair));
    }
    const auto before = static_cast<std::ptrdiff_t>(derived.known.size());
    derived.known.insert(derived.known.end(), fresh.begin(), fresh.end());
    std::inplace_merge(derived.known.begin(), derived.known.begin() + before, derived.known.end());
  }

  /// `pairs` are ascending.
  void eraseStated(TermId property, std::vector<std::uint64_t>& pairs) {
    if (pairs.size() < kManyPairs) {
      std::erase_if(pairs, [&](std::uint64_t pair) { return isStated(pairOf(pair), property); });
      return;
    }
    QuadCursor cursor = reader_.scan({.s = {}, .p = property, .o = {}, .g = {}}, QuadOrder::Posg);
    QuadIds quad;
    bool has_more = cursor.next(quad);
    std::erase_if(pairs, [&](std::uint64_t pair) {
      constexpr int kMaxReadOn = 64;
      for (int read = 0; has_more && key(quad.s, quad.o) < pair; has_more = cursor.next(quad))
        if (++read == kMaxReadOn) cursor.seek({pairOf(pair).subject, property, pairOf(pair).object, 0});
      bool is_stated = false;
      for (; has_more && key(quad.s, quad.o) == pair; has_more = cursor.next(quad))
        is_stated = is_stated || isSource(quad.g);
      return is_stated;
    });
  }

  bool isSource(TermId graph) const { return std::binary_search(sources_.begin(), sources_.end(), graph); }

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

  bool isStated(const Pair& pair, TermId property) {
    const std::array<TermId, 3> prefix = {pair.subject, property, pair.object};
    for (auto keys = lookup_.find(prefix); !keys.empty(); keys = lookup_.more())
      for (const QuadKey& stored : keys)
        if (isSource(stored.at(3))) return true;
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
    only_new_ = only_new;
    for (const auto& [property, implied] : rules_.implications) applyImplications(property, implied);
    for (const TermId property : rules_.transitive) applyTransitivity(property);
    applyTypes();
    return facts_.endRound();
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
        if (next.inverted)
          facts_.derive(object, next.property, subject);
        else
          facts_.derive(subject, next.property, object);
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
          facts_.derive(node, property, reached);
  }

  void applyTypes() {
    visit(words_.type, [&](TermId subject, TermId kind) {
      const auto above = rules_.ancestors.find(kind);
      if (above == rules_.ancestors.end()) return;
      for (const TermId ancestor : above->second) facts_.derive(subject, words_.type, ancestor);
    });
  }

  bool isSchema(TermId property) const { return property == words_.sub_class || property == words_.sub_property; }

  Facts& facts_;
  const QuadReader& reader_;
  const SchemaWords& words_;
  Schema rules_;
  bool only_new_ = false;
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
