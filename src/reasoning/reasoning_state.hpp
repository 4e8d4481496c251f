// SPDX-License-Identifier: Apache-2.0
// The state of one run of the reasoning stage: pieces, objects in the making, and look-ups in the scene.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cluxel/reasoning/reason.hpp"
#include "reasoning/cluxel_grid.hpp"
#include "reasoning/piece_table.hpp"

namespace cluxel {

/// The things bound to names on the way through a tree, in the order they were bound.
struct Bindings {
  std::vector<std::pair<std::string, Thing>> things;

  const Thing& at(const std::string& name) const;
  Thing* find(const std::string& name);
  bool holds(PieceIndex piece) const;
};

struct PartInMaking {
  std::string name;        ///< the bound name
  std::string part_class;  ///< IRI
  std::vector<PieceIndex> pieces;
};

struct ObjectInMaking {
  const Rule* rule = nullptr;
  const AcceptLeaf* leaf = nullptr;
  double confidence = 0;
  std::size_t decision = 0;
  std::vector<PartInMaking> parts;
  Bindings bindings;  ///< for absorbing and parting
};

struct ReasoningState {
  ReasoningState(const Scene& scene_, const RuleSet& rules_, const ReasoningContext& context_);

  const Scene& scene;
  const RuleSet& rules;
  const ReasoningContext& context;
  CluxelGrid grid;
  PieceTable pieces;
  std::vector<ObjectInMaking> objects;
  std::map<PieceIndex, std::vector<OwnerIndex>> claims;  ///< who wants a shared piece
  std::vector<Decision> decisions;
  /// Per primitive, the relations that lead to it: numbers in scene.relations.
  std::vector<std::vector<std::uint32_t>> relations_to;
  std::set<std::pair<std::string, std::string>> is_a;  ///< (class, ancestor) among the classes of the order

  bool belongsTo(PieceIndex piece, const std::string& class_iri) const;
  bool classIsA(const std::string& class_iri, const std::string& ancestor) const;
  /// The pieces of an object, ascending.
  std::vector<PieceIndex> piecesOf(const ObjectInMaking& object) const;
};

}  // namespace cluxel
