// SPDX-License-Identifier: Apache-2.0
// The facts of a store with the stage at which each is known, and what a change makes of them before it is written.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

#include "rdf/ontology/schema.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// A fact is of stage 0 when it is stated or follows from what is stated by the closure, and of stage k when it follows
/// only with what rule k derives.
using Stage = std::uint32_t;
inline constexpr Stage kNever = std::numeric_limits<Stage>::max();  ///< not a fact

struct Triple {
  TermId s = 0, p = 0, o = 0;
  auto operator<=>(const Triple&) const = default;
};

struct TripleHash {
  std::size_t operator()(const Triple& triple) const {
    const std::uint64_t pair = (std::uint64_t{triple.s} << 32U | triple.o) * 0x9E3779B97F4A7C15U;
    return static_cast<std::size_t>((pair ^ (pair >> 29U)) + triple.p * 0xD1B54A32D192ED03U);
  }
};

/// A fact of a stage after 0. `is_base`: a rule derived it, so that it does not need the closure.
struct LateFact {
  Triple fact;
  Stage stage = kNever;
  bool is_base = false;
  auto operator<=>(const LateFact&) const = default;
};

struct FactState {
  Stage before = kNever;  ///< the change
  Stage now = kNever;
  Stage base = kNever;      ///< without the closure: 0 when it is stated, else the stage of the rule that derives it
  bool is_stated = false;   ///< now
  bool is_written = false;  ///< in graph `inferred` of the store
  bool is_waiting = false;  ///< for StagedFacts::write(), which looks at it
};

class StagedFacts {
 public:
  /// `late`: sorted; the facts of graph `inferred` that are not of stage 0. `sources`: graphs of stated facts.
  StagedFacts(const QuadReader& reader, const SchemaWords& words, std::vector<TermId> sources, TermId inferred,
              std::vector<LateFact> late);

  /// Tells that a fact was stated before the change and is not now, or the other way round.
  void restate(const Triple& fact, bool was_stated);

  FactState stateOf(const Triple& fact) const;
  Stage stageOf(const Triple& fact) const { return stateOf(fact).now; }
  /// The state for changing it. Valid until the next call.
  FactState& change(const Triple& fact);
  const std::unordered_map<Triple, FactState, TripleHash>& changed() const { return changed_; }
  const std::vector<Triple>& changedOf(TermId property) const { return of(changed_of_, property); }
  /// Whether a fact that is or was an axiom is among the changed ones: then the schema is another one.
  bool touchesSchema() const { return touches_schema_; }

  using Visit = std::function<void(TermId end, const FactState& state)>;
  /// Visits the objects of a subject, and the subjects of an object; also of facts that have ceased to be.
  void forEachObject(TermId subject, TermId property, const Visit& visit) const;
  void forEachSubject(TermId property, TermId object, const Visit& visit) const;

  /// Brings graph `inferred` of the store to the present state, and flushes.
  void write(QuadWriter& writer);
  /// The facts of later stages before the change.
  const std::vector<LateFact>& lateOf(TermId property) const { return of(late_of_, property); }
  /// The facts of later stages now; sorted.
  std::vector<LateFact> lateNow() const;

 private:
  using Ends = std::unordered_map<TermId, std::vector<TermId>>;
  /// The changed facts of a property by their ends: the first so many.
  struct Links {
    std::size_t known = 0;
    Ends objects, subjects;
  };
  template <typename Fact>
  static const std::vector<Fact>& of(const std::unordered_map<TermId, std::vector<Fact>>& facts, TermId property) {
    static const std::vector<Fact> none;
    const auto found = facts.find(property);
    return found != facts.end() ? found->second : none;
  }
  bool isSource(TermId graph) const;
  std::optional<std::size_t> lateAt(const Triple& fact) const;
  FactState storedState(const Triple& fact) const;
  FactState inferredState(const Triple& fact) const;
  FactState& insert(const Triple& fact, const FactState& state);
  /// Of all changed facts. Most properties are never followed, so that theirs are not made.
  const Links& linksOf(TermId property) const;

  const QuadReader& reader_;
  const SchemaWords& words_;
  std::vector<TermId> sources_;
  TermId inferred_;
  std::vector<LateFact> late_;
  std::unordered_map<Triple, FactState, TripleHash> changed_;
  std::unordered_map<TermId, std::vector<Triple>> changed_of_;  ///< by property
  std::unordered_map<TermId, std::vector<LateFact>> late_of_;
  std::vector<Triple> waiting_;
  mutable std::unordered_map<TermId, Links> links_;
  bool touches_schema_ = false;
};

}  // namespace cluxel::rdf
