// SPDX-License-Identifier: Apache-2.0
// One block a tile, and the structure of the rules that they belong to.
#include "mapping/layers/rule_margins.hpp"

#include <algorithm>
#include <cstring>

#include "mapping/map_tables.hpp"
#include "perception/tile_bytes.hpp"
#include "rules/decide/local_reach.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;
using rules::ThresholdMargin;

constexpr std::string_view kMarginKind = "MRGN", kStructureKey = "rule structure", kReachKey = "rule reach";
constexpr std::uint32_t kMarginVersion = 1;

std::string toBytes(const TileKey& tile, const std::vector<ThresholdMargin>& margins) {
  std::vector<std::uint32_t> thresholds;
  std::vector<double> below, above;
  for (const ThresholdMargin& margin : margins)
    thresholds.push_back(margin.threshold), below.push_back(margin.below), above.push_back(margin.above);
  perception::TileWriter writer(kMarginKind, kMarginVersion, tile);
  writer.putSteps(thresholds);
  writer.put(below), writer.put(above);
  return writer.take();
}

std::vector<ThresholdMargin> marginsFrom(std::string_view bytes) {
  perception::TileReader reader(bytes, kMarginKind, kMarginVersion);
  const std::vector<std::uint32_t> thresholds = reader.getSteps();
  const auto below = reader.getMany<double>(thresholds.size()), above = reader.getMany<double>(thresholds.size());
  reader.finish();
  std::vector<ThresholdMargin> margins;
  for (std::size_t i = 0; i < thresholds.size(); ++i) margins.push_back({thresholds[i], below[i], above[i]});
  return margins;
}

void put(rdf::WriteTransaction& transaction, const TileKey& tile, const std::vector<ThresholdMargin>& margins) {
  const std::string key = tables::keyOf(tile), bytes = toBytes(tile, margins);
  if (const auto old = transaction.block(tables::kMargins, key); old && *old == bytes) return;
  transaction.putBlock(tables::kMargins, key, bytes);
}

std::vector<ThresholdMargin> narrowed(const std::vector<ThresholdMargin>& a, const std::vector<ThresholdMargin>& b) {
  std::vector<ThresholdMargin> both;
  std::merge(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both),
             [](const ThresholdMargin& x, const ThresholdMargin& y) { return x.threshold < y.threshold; });
  std::size_t kept = 0;
  for (const ThresholdMargin& margin : both)
    if (kept > 0 && both[kept - 1].threshold == margin.threshold)
      both[kept - 1].narrow(margin);
    else
      both[kept++] = margin;
  both.resize(kept);
  return both;
}

}  // namespace

void storeMargins(rdf::WriteTransaction& transaction, const rules::TileMargins& margins, const rules::RuleSet& rules) {
  std::vector<std::string> left;
  transaction.forEachBlock(tables::kMargins, "", [&](std::string_view key, std::string_view) {
    if (!margins.contains(tables::tileOfKey(key))) left.emplace_back(key);
  });
  for (const std::string& key : left) transaction.eraseBlock(tables::kMargins, key);
  for (const auto& [tile, of_tile] : margins) put(transaction, tile, of_tile);
  const std::string structure = tables::keyOf(rules.structure);
  if (transaction.block(tables::kMeta, kStructureKey) != structure)
    transaction.putBlock(tables::kMeta, kStructureKey, structure);
  storeReach(transaction, rules);
}

std::optional<double> storedReach(const rdf::ReadTransaction& transaction) {
  const auto bytes = transaction.block(tables::kMeta, kReachKey);
  if (!bytes || bytes->size() != sizeof(double)) return std::nullopt;
  double reach_m = 0;
  std::memcpy(&reach_m, bytes->data(), sizeof(reach_m));
  return reach_m >= 0 ? std::optional(reach_m) : std::nullopt;
}

void storeReach(rdf::WriteTransaction& transaction, const rules::RuleSet& rules) {
  const double reach_m = rules::localReach(rules).reach_m.value_or(-1);
  const std::string bytes(reinterpret_cast<const char*>(&reach_m), sizeof(reach_m));
  if (transaction.block(tables::kMeta, kReachKey) != bytes) transaction.putBlock(tables::kMeta, kReachKey, bytes);
}

void updateMargins(rdf::WriteTransaction& transaction, const rules::TileMargins& margins, const TileSet& tiles,
                   const TileSet& decided) {
  for (const TileKey& tile : tiles) {
    const std::string key = tables::keyOf(tile);
    const auto found = margins.find(tile);
    std::vector<ThresholdMargin> now = found == margins.end() ? std::vector<ThresholdMargin>{} : found->second;
    if (const auto stored = transaction.block(tables::kMargins, key); stored && !decided.contains(tile))
      now = narrowed(marginsFrom(*stored), now);
    if (now.empty())
      transaction.eraseBlock(tables::kMargins, key);
    else
      put(transaction, tile, now);
  }
}

std::optional<TileSet> tilesBeyondMargins(const rdf::ReadTransaction& transaction, const rules::RuleSet& rules) {
  if (transaction.block(tables::kMeta, kStructureKey) != tables::keyOf(rules.structure)) return std::nullopt;
  rules::TileMargins margins;
  transaction.forEachBlock(tables::kMargins, "", [&](std::string_view key, std::string_view bytes) {
    margins[tables::tileOfKey(key)] = marginsFrom(bytes);
  });
  for (const auto& [tile, of_tile] : margins)
    if (!of_tile.empty() && of_tile.back().threshold > rules.thresholds.size()) return std::nullopt;
  return tilesBeyond(margins, rules);
}

}  // namespace cluxel::mapping
