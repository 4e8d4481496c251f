// SPDX-License-Identifier: Apache-2.0
// Forward chaining of the RDFS and OWL rules over an ontology and its facts, to a fixpoint.
#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <unordered_set>

#include "rdf/ontology/closure_bounds.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

/// The ids of the vocabulary terms used by the rules; 0 when the store does not contain the term.
struct Words {
  TermId type = 0, sub_class = 0, sub_property = 0, inverse = 0, symmetric = 0, transitive = 0;

  explicit Words(const QuadReader& reader) {
    const auto id = [&](const std::string& iri) { return reader.idOf(Term::iri(iri)).value_or(kNoTerm); };
    const std::string owl(vocabulary::kOwl);
    type = id(vocabulary::rdf("type"));
    sub_class = id(vocabulary::rdfs("subClassOf"));
    sub_property = id(vocabulary::rdfs("subPropertyOf"));
    inverse = id(owl + "inverseOf");
    symmetric = id(owl + "SymmetricProperty");
    transitive = id(owl + "TransitiveProperty");
  }

  /// A property by which the rules themselves work. An axiom about it would turn every fact into schema.
  bool isReserved(TermId property) const {
    return property != kNoTerm &&
           (property == type || property == sub_class || property == sub_property || property == inverse);
  }
};

struct Pair {
  TermId subject = 0, object = 0;
};

/// A property implied by another one.
struct Implied {
  TermId property = 0;
  bool inverted = false;     ///< subject and object are swapped
  bool via_inverse = false;  ///< an intermediate step swapped them, so literals are excluded: they cannot be subjects
  auto operator<=>(const Implied&) const = default;
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
    if (property == kNoTerm) return;
    QuadCursor cursor = reader_.scan({.s = {}, .p = property, .o = {}, .g = {}}, QuadOrder::Posg);
    for (QuadIds quad; cursor.next(quad);) {
      bounds_.addStep(property);
      if (std::binary_search(sources_.begin(), sources_.end(), quad.g)) visit(quad.s, quad.o);
    }
    forEachDerived(property, 0, visit);
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
  bool isIri(TermId id) const { return reader_.valueOf(id).kind == TermKind::Iri; }
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

using Edges = std::map<TermId, std::set<TermId>>;

Edges edgesOf(const Facts& facts, TermId property) {
  Edges edges;
  facts.forEach(property, [&](TermId subject, TermId object) { edges[subject].insert(object); });
  return edges;
}

/// All nodes reachable from a node along a property.
std::set<TermId> reachableFrom(TermId node, const Edges& edges, TermId property, ClosureBounds& bounds) {
  std::set<TermId> reached;
  std::vector<TermId> open = {node};
  while (!open.empty()) {
    const auto next = edges.find(open.back());
    open.pop_back();
    if (next == edges.end()) continue;
    for (const TermId target : next->second) {
      bounds.addStep(property);
      if (reached.insert(target).second) open.push_back(target);
    }
  }
  return reached;
}

/// The schema, extracted from the known facts.
struct OntologyRules {
  std::map<TermId, std::set<Implied>> implications;  ///< the implied properties of each property
  std::set<TermId> transitive;
  Edges ancestors;                          ///< of each class
  std::set<std::array<TermId, 3>> ignored;  ///< axioms about reserved properties: subject, predicate, object
  bool operator==(const OntologyRules&) const = default;
};

std::set<Implied> allImplied(TermId property, const std::map<TermId, std::set<Implied>>& direct,
                             ClosureBounds& bounds) {
  std::set<Implied> reached;
  std::vector<Implied> open(direct.at(property).begin(), direct.at(property).end());
  while (!open.empty()) {
    const Implied next = open.back();
    open.pop_back();
    bounds.addStep(property);
    if (!reached.insert(next).second) continue;
    const auto further = direct.find(next.property);
    if (further == direct.end()) continue;
    for (const Implied& step : further->second)
      open.push_back({step.property, step.inverted != next.inverted, step.via_inverse || next.via_inverse});
  }
  reached.erase({property, false, false});
  return reached;
}

using DirectImplications = std::map<TermId, std::set<Implied>>;

/// The axioms on properties. Those about reserved properties are set aside in `rules.ignored`.
DirectImplications readAxioms(const Facts& facts, const Words& words, OntologyRules& rules) {
  DirectImplications direct;
  const auto heeded = [&](TermId subject, TermId predicate, TermId object) {
    if (!words.isReserved(subject) && (predicate == words.type || !words.isReserved(object))) return true;
    rules.ignored.insert({subject, predicate, object});
    return false;
  };
  facts.forEach(words.sub_property, [&](TermId sub, TermId super) {
    if (sub != super && heeded(sub, words.sub_property, super)) direct[sub].insert({super, false, false});
  });
  facts.forEach(words.inverse, [&](TermId one, TermId other) {
    if (!heeded(one, words.inverse, other)) return;
    direct[one].insert({other, true, true});
    direct[other].insert({one, true, true});
  });
  facts.forEach(words.type, [&](TermId property, TermId kind) {
    if ((kind != words.symmetric && kind != words.transitive) || !heeded(property, words.type, kind)) return;
    if (kind == words.symmetric) direct[property].insert({property, true, true});
    if (kind == words.transitive) rules.transitive.insert(property);
  });
  return direct;
}

OntologyRules readRules(const Facts& facts, const Words& words) {
  OntologyRules rules;
  const DirectImplications direct = readAxioms(facts, words, rules);
  for (const TermId property : {words.sub_class, words.sub_property})
    if (property != kNoTerm) rules.transitive.insert(property);
  // A blank node such as [ owl:inverseOf p ] takes part in the schema, but cannot be the predicate of a fact.
  const auto is_no_predicate = [&](const Implied& implied) { return !facts.isIri(implied.property); };
  for (const auto& [property, first] : direct)
    std::erase_if(rules.implications.emplace(property, allImplied(property, direct, facts.bounds())).first->second,
                  is_no_predicate);
  const Edges above = edgesOf(facts, words.sub_class);
  for (const auto& [kind, direct_ones] : above)
    rules.ancestors.emplace(kind, reachableFrom(kind, above, words.sub_class, facts.bounds()));
  return rules;
}

/// Semi-naive evaluation: after the first round only new facts are joined, unless the schema has changed.
class Closure {
 public:
  Closure(Facts& facts, const Words& words) : facts_(facts), words_(words) {}

  /// `only_new`: the facts without those of Facts::setNew() are closed.
  void run(bool only_new) {
    rules_ = readRules(facts_, words_);
    while (round(only_new)) {
      facts_.beginRound();
      OntologyRules rules = readRules(facts_, words_);
      only_new = rules == rules_;
      rules_ = std::move(rules);
    }
  }
  const std::set<std::array<TermId, 3>>& ignored() const { return rules_.ignored; }

 private:
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
  const Words& words_;
  OntologyRules rules_;
  bool only_new_ = false;
  bool changed_ = false;
};

}  // namespace

ClosureLimits ClosureLimits::of(const QuadReader& reader) {
  return {5'000'000 + 4 * reader.size(), 200'000'000 + 100 * reader.size(), {}};
}

EntailedQuads closureOf(const QuadReader& reader, TermId target, std::span<const TermId> sources,
                        const ClosureLimits& limits, std::span<const QuadIds> fresh) {
  const Words words(reader);
  ClosureBounds bounds(reader, limits);
  Facts facts(reader, sources, bounds);
  const bool only_new = !fresh.empty() && std::none_of(fresh.begin(), fresh.end(), [&](const QuadIds& quad) {
    return quad.p == words.sub_class || quad.p == words.sub_property || quad.p == words.inverse ||
           (quad.p == words.type && (quad.o == words.symmetric || quad.o == words.transitive));
  });
  if (only_new) facts.setNew(fresh);
  Closure closure(facts, words);
  closure.run(only_new);
  EntailedQuads entailed{facts.derivedQuads(target), {}};
  for (const auto& [subject, predicate, object] : closure.ignored())
    entailed.ignored.push_back(toNTriples(reader.termOf(subject)) + ' ' + toNTriples(reader.termOf(predicate)) + ' ' +
                               toNTriples(reader.termOf(object)));
  std::sort(entailed.ignored.begin(), entailed.ignored.end());
  return entailed;
}

}  // namespace cluxel::rdf
