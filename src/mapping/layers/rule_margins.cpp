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
using rules::TileMargin;

constexpr std::string_view kMarginKind = "MRGN", kStructureKey = "rule structure", kNumbersKey = "rule numbers";
constexpr std::uint32_t kMarginVersion = 2;

std::string toBytes(const TileKey& tile, const TileMargin& margin) {
  std::vector<std::uint32_t> thresholds;
  std::vector<double> below, above;
  for (const ThresholdMargin& of : margin.thresholds)
    thresholds.push_back(of.threshold), below.push_back(of.below), above.push_back(of.above);
  perception::TileWriter writer(kMarginKind, kMarginVersion, tile);
  writer.putSteps(thresholds);
  writer.put(below), writer.put(above);
  writer.putSteps(margin.constants);
  return writer.take();
}

TileMargin marginFrom(std::string_view bytes) {
  perception::TileReader reader(bytes, kMarginKind, kMarginVersion);
  const std::vector<std::uint32_t> thresholds = reader.getSteps();
  const auto below = reader.getMany<double>(thresholds.size()), above = reader.getMany<double>(thresholds.size());
  TileMargin margin;
  margin.constants = reader.getSteps();
  reader.finish();
  for (std::size_t i = 0; i < thresholds.size(); ++i) margin.thresholds.push_back({thresholds[i], below[i], above[i]});
  return margin;
}

void put(rdf::WriteTransaction& transaction, const TileKey& tile, const TileMargin& margin) {
  transaction.putIfDifferent(tables::kMargins, tables::keyOf(tile), toBytes(tile, margin));
}

/// What both allow.
TileMargin narrowed(const TileMargin& a, const TileMargin& b) {
  TileMargin both;
  std::merge(a.thresholds.begin(), a.thresholds.end(), b.thresholds.begin(), b.thresholds.end(),
             std::back_inserter(both.thresholds),
             [](const ThresholdMargin& x, const ThresholdMargin& y) { return x.threshold < y.threshold; });
  std::size_t kept = 0;
  for (const ThresholdMargin& margin : both.thresholds)
    if (kept > 0 && both.thresholds[kept - 1].threshold == margin.threshold)
      both.thresholds[kept - 1].narrow(margin);
    else
      both.thresholds[kept++] = margin;
  both.thresholds.resize(kept);
  std::set_union(a.constants.begin(), a.constants.end(), b.constants.begin(), b.constants.end(),
                 std::back_inserter(both.constants));
  return both;
}

/// What the margins do not tell of the rules by which the map was decided.
struct RuleNumbers {
  double reach_m = -1;  ///< how far they look; negative when that is not bounded
  std::vector<std::uint64_t> constants;
};

RuleNumbers numbersOf(const rules::RuleSet& rules) {
  return {rules::localReach(rules).reach_m.value_or(-1), rules.constants};
}

std::optional<RuleNumbers> storedNumbers(const rdf::ReadTransaction& transaction) {
  const auto bytes = transaction.block(tables::kMeta, kNumbersKey);
  if (!bytes || bytes->size() % sizeof(std::uint64_t) != 0 || bytes->empty()) return std::nullopt;
  RuleNumbers numbers;
  numbers.constants.resize(bytes->size() / sizeof(std::uint64_t) - 1);
  std::memcpy(&numbers.reach_m, bytes->data(), sizeof(double));
  if (!numbers.constants.empty())
    std::memcpy(numbers.constants.data(), bytes->data() + sizeof(double), bytes->size() - sizeof(double));
  return numbers;
}

}  // namespace

void storeMargins(rdf::WriteTransaction& transaction, const rules::TileMargins& margins, const rules::RuleSet& rules) {
  std::vector<std::string> left;
  transaction.forEachBlock(tables::kMargins, "", [&](std::string_view key, std::string_view) {
    if (!margins.contains(tables::tileOfKey(key))) left.emplace_back(key);
  });
  for (const std::string& key : left) transaction.eraseBlock(tables::kMargins, key);
  for (const auto& [tile, of_tile] : margins) put(transaction, tile, of_tile);
  storeNumbers(transaction, rules);
}

void storeNumbers(rdf::WriteTransaction& transaction, const rules::RuleSet& rules) {
  transaction.putIfDifferent(tables::kMeta, kStructureKey, tables::keyOf(rules.structure));
  const RuleNumbers numbers = numbersOf(rules);
  std::string bytes(sizeof(double) + numbers.constants.size() * sizeof(std::uint64_t), '\0');
  std::memcpy(bytes.data(), &numbers.reach_m, sizeof(double));
  if (!numbers.constants.empty())
    std::memcpy(bytes.data() + sizeof(double), numbers.constants.data(), bytes.size() - sizeof(double));
  transaction.putIfDifferent(tables::kMeta, kNumbersKey, bytes);
}

void updateMargins(rdf::WriteTransaction& transaction, const rules::TileMargins& margins, const TileSet& tiles,
                   const TileSet& decided) {
  for (const TileKey& tile : tiles) {
    const std::string key = tables::keyOf(tile);
    const auto found = margins.find(tile);
    TileMargin now = found == margins.end() ? TileMargin{} : found->second;
    if (const auto stored = transaction.block(tables::kMargins, key); stored && !decided.contains(tile))
      now = narrowed(marginFrom(*stored), now);
    if (now == TileMargin{})
      transaction.eraseBlock(tables::kMargins, key);
    else
      put(transaction, tile, now);
  }
}

std::optional<RuleChange> changeOfRules(const rdf::ReadTransaction& transaction, const rules::RuleSet& rules) {
  const auto former = storedNumbers(transaction);
  if (transaction.block(tables::kMeta, kStructureKey) != tables::keyOf(rules.structure)) return std::nullopt;
  if (!former || former->reach_m < 0) return std::nullopt;
  rules::TileMargins margins;
  transaction.forEachBlock(tables::kMargins, "", [&](std::string_view key, std::string_view bytes) {
    margins[tables::tileOfKey(key)] = marginFrom(bytes);
  });
  const auto isBeyond = [](const auto& numbers, std::size_t count, const auto& number_of) {
    return !numbers.empty() && number_of(numbers.back()) > count;
  };
  for (const auto& [tile, margin] : margins)
    if (isBeyond(margin.thresholds, rules.thresholds.size(), [](const auto& of) { return of.threshold; }) ||
        isBeyond(margin.constants, rules.constants.size(), [](std::uint32_t number) { return number; }))
      return std::nullopt;
  if (former->constants.size() != rules.constants.size()) return std::nullopt;
  return RuleChange{tilesBeyond(margins, former->constants, rules), former->reach_m};
}

}  // namespace cluxel::mapping
