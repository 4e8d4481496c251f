// SPDX-License-Identifier: Apache-2.0
// The closure of an ontology and the facts it speaks of, to the fixpoint.
#include <algorithm>
#include <map>
#include <set>

#include "cluxel/knowledge/ontology.hpp"
#include "cluxel/knowledge/vocabulary.hpp"

namespace cluxel {

namespace {

/// The ids of the words that the rules are about; 0 where the store does not know the word.
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
};

using Pair = std::pair<TermId, TermId>;
using Pairs = std::set<Pair>;

/// A property that follows from another.
struct Implied {
  TermId property = 0;
  bool turned = false;      ///< subject and object are exchanged
  bool by_turning = false;  ///< on the way they were: not for literals, which cannot be subjects
  auto operator<=>(const Implied&) const = default;
};

/// The facts known so far, by property: those of the store on demand, and all that has been derived.
class Facts {
 public:
  Facts(const QuadReader& reader, std::span<const TermId> sources)
      : reader_(reader), sources_(sources.begin(), sources.end()) {
    std::sort(sources_.begin(), sources_.end());
  }

  /// Calls visit(subject, object) for every fact of a property, stated or derived so far.
  template <typename Visit>
  void forEach(TermId property, const Visit& visit) const {
    if (property == kNoTerm) return;
    QuadCursor cursor = reader_.scan({.s = {}, .p = property, .o = {}, .g = {}}, QuadOrder::Posg);
    for (QuadIds quad; cursor.next(quad);)
      if (std::binary_search(sources_.begin(), sources_.end(), quad.g)) visit(quad.s, quad.o);
    const auto derived = derived_.find(property);
    if (derived == derived_.end()) return;
    const Pairs copy = derived->second;
    for (const Pair& pair : copy) visit(pair.first, pair.second);
  }

  /// True when it is new.
  bool derive(TermId subject, TermId property, TermId object) {
    if (isStated(subject, property, object)) return false;
    return derived_[property].insert({subject, object}).second;
  }

  const std::map<TermId, Pairs>& derived() const { return derived_; }
  bool isResource(TermId id) const { return reader_.valueOf(id).kind != TermKind::Literal; }

 private:
  bool isStated(TermId subject, TermId property, TermId object) const {
    if (!lookup_) lookup_.emplace(reader_.lookup(QuadOrder::Spog));
    const std::array<TermId, 3> prefix = {subject, property, object};
    for (auto keys = lookup_->find(prefix); !keys.empty(); keys = lookup_->more())
      for (const QuadKey& key : keys)
        if (std::binary_search(sources_.begin(), sources_.end(), key.at(3))) return true;
    return false;
  }

  const QuadReader& reader_;
  std::vector<TermId> sources_;
  mutable std::optional<PrefixLookup> lookup_;
  std::map<TermId, Pairs> derived_;
};

/// What the ontology says about properties, taken from the facts known so far.
class PropertyRules {
 public:
  PropertyRules(const Facts& facts, const Words& words) {
    facts.forEach(words.sub_property, [&](TermId sub, TermId super) {
      direct_[sub].insert({super, false, false});
    });
    facts.forEach(words.inverse, [&](TermId one, TermId other) {
      direct_[one].insert({other, true, true});
      direct_[other].insert({one, true, true});
    });
    facts.forEach(words.type, [&](TermId property, TermId kind) {
      if (kind == words.symmetric) direct_[property].insert({property, true, true});
      if (kind == words.transitive) transitive_.insert(property);
    });
    for (const TermId property : {words.sub_class, words.sub_property})
      if (property != kNoTerm) transitive_.insert(property);
  }

  const std::set<TermId>& transitive() const { return transitive_; }

  /// Every property that implies something, with all it implies.
  std::map<TermId, std::set<Implied>> implications() const {
    std::map<TermId, std::set<Implied>> all;
    for (const auto& [property, first] : direct_) {
      std::set<Implied> reached;
      std::vector<Implied> open(first.begin(), first.end());
      while (!open.empty()) {
        const Implied next = open.back();
        open.pop_back();
        if (!reached.insert(next).second) continue;
        const auto further = direct_.find(next.property);
        if (further == direct_.end()) continue;
        for (const Implied& step : further->second)
          open.push_back({step.property, step.turned != next.turned, step.by_turning || next.by_turning});
      }
      reached.erase({property, false, false});
      all.emplace(property, std::move(reached));
    }
    return all;
  }

 private:
  std::map<TermId, std::set<Implied>> direct_;
  std::set<TermId> transitive_;
};

/// Everything that one node reaches, by the edges of a transitive property.
std::set<TermId> reachableFrom(TermId node, const std::map<TermId, std::set<TermId>>& edges) {
  std::set<TermId> reached;
  std::vector<TermId> open = {node};
  while (!open.empty()) {
    const auto next = edges.find(open.back());
    open.pop_back();
    if (next == edges.end()) continue;
    for (const TermId target : next->second)
      if (reached.insert(target).second) open.push_back(target);
  }
  return reached;
}

/// One round of each rule; true when something new was derived.
class Round {
 public:
  Round(Facts& facts, const Words& words) : facts_(facts), words_(words), rules_(facts, words) {}

  bool run() {
    for (const auto& [property, implied] : rules_.implications()) applyImplications(property, implied);
    for (const TermId property : rules_.transitive()) applyTransitivity(property);
    applyTypes();
    return changed_;
  }

 private:
  void applyImplications(TermId property, const std::set<Implied>& implied) {
    facts_.forEach(property, [&](TermId subject, TermId object) {
      const bool may_turn = facts_.isResource(object);
      for (const Implied& next : implied) {
        if (next.by_turning && !may_turn) continue;
        changed_ |= next.turned ? facts_.derive(object, next.property, subject)
                                : facts_.derive(subject, next.property, object);
      }
    });
  }

  void applyTransitivity(TermId property) {
    const std::map<TermId, std::set<TermId>> edges = edgesOf(property);
    for (const auto& [node, targets] : edges)
      for (const TermId reached : reachableFrom(node, edges))
        // A class in a cycle of subclasses would become its own superclass, which tells nothing.
        if (!targets.contains(reached) && (reached != node || !isSchema(property)))
          changed_ |= facts_.derive(node, property, reached);
  }

  void applyTypes() {
    const std::map<TermId, std::set<TermId>> above = edgesOf(words_.sub_class);
    std::map<TermId, std::set<TermId>> ancestors;
    facts_.forEach(words_.type, [&](TermId subject, TermId kind) {
      auto known = ancestors.find(kind);
      if (known == ancestors.end()) known = ancestors.emplace(kind, reachableFrom(kind, above)).first;
      for (const TermId ancestor : known->second) changed_ |= facts_.derive(subject, words_.type, ancestor);
    });
  }

  std::map<TermId, std::set<TermId>> edgesOf(TermId property) const {
    std::map<TermId, std::set<TermId>> edges;
    facts_.forEach(property, [&](TermId subject, TermId object) { edges[subject].insert(object); });
    return edges;
  }

  bool isSchema(TermId property) const {
    return property == words_.sub_class || property == words_.sub_property;
  }

  Facts& facts_;
  const Words& words_;
  PropertyRules rules_;
  bool changed_ = false;
};

}  // namespace

std::vector<QuadIds> closureOf(const QuadReader& reader, TermId target, std::span<const TermId> sources) {
  const Words words(reader);
  Facts facts(reader, sources);
  while (Round(facts, words).run()) {
  }
  std::vector<QuadIds> inferred;
  for (const auto& [property, pairs] : facts.derived())
    for (const Pair& pair : pairs) inferred.push_back({pair.first, property, pair.second, target});
  std::sort(inferred.begin(), inferred.end());
  return inferred;
}

}  // namespace cluxel
