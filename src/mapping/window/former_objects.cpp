// SPDX-License-Identifier: Apache-2.0
// Collects members tile by tile. A stored layer uses the cluxel numbers of the summary of its own commit.
#include "mapping/window/former_objects.hpp"

#include "mapping/damaged_map.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

void MemberLists::add(const TileLayer& layer, const perception::SummaryTile& summary, bool has_places,
                      const std::function<bool(const ContentHash&)>& is_wanted) {
  if (layer.size() != summary.size()) refuseDamaged("stored objects are of other cluxels");
  std::vector<Collected*> of_share;
  std::vector<std::uint64_t> part_of_share;
  for (const TileLayer::Share& share : layer.shares) {
    of_share.push_back(nullptr);
    part_of_share.push_back(partKey(share.part_class));
    if (!is_wanted(share.object)) continue;
    const auto [place, is_new] = objects_.try_emplace(share.object);
    of_share.back() = &place->second;
    if (!is_new) continue;
    place->second.members.id = share.object;
    if (const auto record = storedRecord(transaction_, share.object)) {
      place->second.members.class_iri = record->class_iri;
      place->second.is_class_wide = record->is_class_wide;
      if (record->is_class_wide) continue;
      place->second.members.rule_id = record->rule_id;
      place->second.members.confidence = record->confidence;
    }
  }
  const Eigen::Vector3d corner = grid_.cornerOf(layer.key);
  const std::vector<const Eigen::Isometry3d*> motions = motionsOf(summary.scans);
  for (std::size_t c = 0; c < layer.size(); ++c) {
    const std::uint32_t share = layer.share_of_cluxel[c];
    if (share == kNoShare || of_share[share] == nullptr) continue;
    ObjectMembers& members = of_share[share]->members;
    members.seeds.push_back(memberKey(summary.scans[summary.seed_scan[c]], summary.seed_point[c]));
    if (!of_share[share]->is_class_wide) members.addToPart(part_of_share[share], members.seeds.back());
    if (of_share[share]->is_class_wide || (!has_places && members.places.empty())) continue;
    members.places.resize(members.seeds.size(), kNoMemberPlace);
    if (!has_places) continue;
    const Eigen::Vector3d p = corner + summary.mean[c].cast<double>();
    const Eigen::Isometry3d* motion = motions[summary.seed_scan[c]];
    members.places.back() = placeOf(motion != nullptr ? *motion * p : p);
  }
}

std::vector<const Eigen::Isometry3d*> MemberLists::motionsOf(const std::vector<ContentHash>& scans) const {
  std::vector<const Eigen::Isometry3d*> motions;
  for (const ContentHash& scan : scans) {
    const auto moved = motions_.find(scan);
    motions.push_back(moved == motions_.end() ? nullptr : &moved->second);
  }
  return motions;
}

std::vector<ObjectMembers> MemberLists::take() {
  std::vector<ObjectMembers> all;
  for (auto& [id, collected] : objects_) all.push_back(std::move(collected.members));
  objects_.clear();
  return all;
}

std::vector<ObjectMembers> storedMembers(const rdf::ReadTransaction& transaction, CloudMotions motions) {
  MemberLists members(transaction, std::move(motions));
  forEachStoredLayer(transaction, [&](const TileLayer& layer) {
    const std::string_view summary = requiredBlock(transaction, tables::kSummaries, layer.key);
    members.add(layer, perception::seedsFromBytes(summary), true, [](const ContentHash&) { return true; });
  });
  return members.take();
}

const perception::SummaryTile* FormerObjects::summaryOf(const perception::TileKey& tile) const {
  if (former_.hasChanged(tile)) return former_.of(tile);
  const auto same = stages_.summaries().find(tile);
  if (same == stages_.summaries().end()) refuseIncompleteTile();
  return &same->second;
}

void FormerObjects::add(const TileLayer& layer, const std::function<bool(const ContentHash&)>& is_wanted) {
  if (const perception::SummaryTile* summary = summaryOf(layer.key))
    members_.add(layer, *summary, former_.hasChanged(layer.key) || will_change_(layer.key), is_wanted);
}

std::vector<ObjectMembers> formerObjects(const rdf::ReadTransaction& transaction, const OutputChanges& changes,
                                         CloudMotions motions) {
  MemberLists members(transaction, std::move(motions));
  forEachStoredLayer(transaction, [&](const TileLayer& layer) {
    const auto changed = changes.former_summaries.find(layer.key);
    const bool is_other = changed != changes.former_summaries.end();
    if (is_other && !changed->second) return;
    const std::string_view summary =
        is_other ? std::string_view(*changed->second) : requiredBlock(transaction, tables::kSummaries, layer.key);
    members.add(layer, perception::seedsFromBytes(summary), is_other, [](const ContentHash&) { return true; });
  });
  return members.take();
}

}  // namespace cluxel::mapping
