// SPDX-License-Identifier: Apache-2.0
// Follows changes of stated and derived facts through the closure of an ontology that stays the same.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "rdf/ontology/closure_bounds.hpp"
#include "rdf/ontology/schema.hpp"
#include "rdf/ontology/staged_facts.hpp"

namespace cluxel::rdf {

/// From now on a fact holds from this stage on without the closure; kNever: not without it.
struct BaseChange {
  Triple fact;
  Stage base = kNever;
};

/// Keeps the stage of each fact the least one that the closure gives: that of a derivation is the greatest of its
/// premises. For a removed fact, everything that may follow from it is taken away first, and what still follows from
/// the rest is put back (delete and rederive; Gupta, Mumick and Subrahmanian 1993): facts that support each other in a
/// cycle fall with their only support. Cost: that of the facts whose stage changes, with their neighbours along
/// transitive properties.
class StagedClosure {
 public:
  StagedClosure(const QuadReader& reader, const SchemaWords& words, const Schema& schema, StagedFacts& facts,
                ClosureBounds& bounds);
  void update(std::span<const BaseChange> changes);
  /// The facts that have lost a derivation of their stage in some update, in this order: gone, of a later stage, or
  /// standing on another derivation. Some may be named several times.
  const std::vector<Triple>& weakened() const { return weakened_; }

 private:
  struct Reached {
    Triple fact;
    Stage stage;
  };
  template <typename Visit>
  void forEachConsequence(const Triple& fact, Stage stage, const Visit& visit) const;
  Stage bestDerivation(const Triple& fact) const;
  std::vector<Triple> takeAway(std::vector<Triple> open);
  void lower(const Triple& fact, Stage stage);
  void settle();
  bool isResource(TermId id) const { return reader_.valueOf(id).kind != TermKind::Literal; }

  const QuadReader& reader_;
  const SchemaWords& words_;
  const Schema& schema_;
  StagedFacts& facts_;
  ClosureBounds& bounds_;
  std::map<TermId, std::vector<Implied>> implying_;  ///< Implied::property is the one that implies the key
  std::vector<Triple> weakened_;
  std::vector<Reached> open_;  ///< a heap, the least stage first
};

/// The schema of a closed store, read by prefix.
Schema readStoredSchema(const QuadReader& reader, const SchemaWords& words, std::span<const TermId> graphs,
                        ClosureBounds& bounds);

}  // namespace cluxel::rdf
