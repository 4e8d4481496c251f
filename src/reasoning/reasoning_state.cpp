// SPDX-License-Identifier: Apache-2.0
// Look-ups that the whole stage shares.
#include "reasoning/reasoning_state.hpp"

#include <algorithm>
#include <stdexcept>

namespace cluxel {

const Thing& Bindings::at(const std::string& name) const {
  for (const auto& [bound, thing] : things)
    if (bound == name) return thing;
  throw std::logic_error("a rule uses the unbound name " + name);
}

Thing* Bindings::find(const std::string& name) {
  for (auto& [bound, thing] : things)
    if (bound == name) return &thing;
  return nullptr;
}

bool Bindings::holds(PieceIndex piece) const {
  return std::any_of(things.begin(), things.end(), [&](const auto& entry) {
    return std::binary_search(entry.second.pieces.begin(), entry.second.pieces.end(), piece);
  });
}

ReasoningState::ReasoningState(const Scene& scene_, const RuleSet& rules_, const ReasoningContext& context_)
    : scene(scene_), rules(rules_), context(context_), grid(scene_.cluxels), pieces(scene_) {
  relations_to.resize(scene.primitives.size());
  for (std::uint32_t i = 0; i < scene.relations.size(); ++i) relations_to[scene.relations[i].to].push_back(i);
  std::vector<std::string> classes = rules.order;
  for (const ClassEntry& entry : rules.catalogue.classes) classes.push_back(entry.iri);
  for (const std::string& made : rules.order)
    for (const std::string& ancestor : classes)
      if (rules.catalogue.isA(made, ancestor)) is_a.emplace(made, ancestor);
}

bool ReasoningState::classIsA(const std::string& class_iri, const std::string& ancestor) const {
  return is_a.count({class_iri, ancestor}) > 0;
}

bool ReasoningState::belongsTo(PieceIndex piece, const std::string& class_iri) const {
  const OwnerIndex owner = pieces[piece].owner;
  if (owner < objects.size()) return classIsA(objects[owner].rule->class_iri, class_iri);
  const auto claim = claims.find(piece);
  return claim != claims.end() && classIsA(objects[claim->second.front()].rule->class_iri, class_iri);
}

std::vector<PieceIndex> ReasoningState::piecesOf(const ObjectInMaking& object) const {
  std::vector<PieceIndex> all;
  for (const PartInMaking& part : object.parts) all.insert(all.end(), part.pieces.begin(), part.pieces.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace cluxel
