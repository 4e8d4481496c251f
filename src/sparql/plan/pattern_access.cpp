// SPDX-License-Identifier: Apache-2.0
// Selects index orders and filters index entries.
#include "sparql/plan/pattern_access.hpp"

#include <algorithm>

namespace cluxel::sparql {

QuadPlaces placesOfPattern(const TripleNode& pattern) {
  QuadPlaces places = {pattern.subject, pattern.predicate, pattern.object, PatternPlace{}};
  if (pattern.graph.kind == GraphPlace::Kind::Constant) places[3].constant = pattern.graph.constant;
  if (pattern.graph.kind == GraphPlace::Kind::Slot) places[3].slot = pattern.graph.slot;
  return places;
}

GraphFilter graphFilterOf(const TripleNode& pattern, const Dataset& dataset) {
  if (pattern.graph.kind == GraphPlace::Kind::Default) return dataset.default_graph;
  GraphFilter named;
  named.kind = GraphFilter::Kind::AnyOf;
  named.graphs = dataset.named;
  named.may_repeat = false;
  return named;
}

OrderChoice chooseOrder(BoundMask bound) {
  OrderChoice best;
  for (const rdf::QuadOrder order :
       {rdf::QuadOrder::Spog, rdf::QuadOrder::Posg, rdf::QuadOrder::Ospg, rdf::QuadOrder::Gspo}) {
    const auto places = placesOf(order);
    std::size_t prefix = 0;
    while (prefix < 4 && (bound >> places[prefix] & 1) != 0) ++prefix;
    // Ties go to the earlier order; without bound positions that is the order by subject.
    if (prefix > best.prefix) best = {order, prefix};
  }
  return best;
}

EntryReader::EntryReader(const TripleNode& pattern, const GraphFilter& graphs, rdf::QuadOrder order, BoundMask bound)
    : graphs_(&graphs), excluded_(pattern.not_predicates) {
  const QuadPlaces places = placesOfPattern(pattern);
  const auto place_at = placesOf(order);
  std::array<std::uint8_t, 4> position_of{};
  for (std::uint8_t i = 0; i < 4; ++i) position_of[place_at[i]] = i;
  graph_position_ = position_of[3];
  predicate_position_ = position_of[1];
  std::size_t prefix = 0;
  while (prefix < 4 && (bound >> place_at[prefix] & 1) != 0) ++prefix;
  for (std::uint8_t place = 0; place < 4; ++place) {
    if ((bound >> place & 1) != 0) {
      if (position_of[place] >= prefix) checks_[check_count_++] = {position_of[place], place};
      continue;
    }
    if (!places[place].isSlot()) continue;
    bool repeated = false;
    for (std::uint8_t earlier = 0; earlier < place && !repeated; ++earlier) {
      if (!places[earlier].isSlot() || places[earlier].slot != places[place].slot) continue;
      same_[same_count_++] = {position_of[earlier], position_of[place]};
      repeated = true;
    }
    if (!repeated) outputs_[output_count_++] = {places[place].slot, position_of[place]};
  }
  const bool graph_bound = (bound & 8) != 0;
  test_graph_ = !graph_bound && graphs.kind != GraphFilter::Kind::Any;
  skip_repeats_ = !graph_bound && pattern.graph.kind == GraphPlace::Kind::Default && graphs.may_repeat;
}

bool EntryReader::samePlacesAgree(const rdf::QuadKey& key) const {
  for (std::size_t i = 0; i < same_count_; ++i) {
    if (key.at(same_[i].position) != key.at(same_[i].place)) return false;
  }
  return true;
}

bool EntryReader::isExcluded(const rdf::QuadKey& key) const {
  const rdf::TermId predicate = key.at(predicate_position_);
  return std::find(excluded_.begin(), excluded_.end(), predicate) != excluded_.end();
}

}  // namespace cluxel::sparql
