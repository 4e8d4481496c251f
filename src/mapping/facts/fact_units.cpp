// SPDX-License-Identifier: Apache-2.0
// One block a unit, and the number of quads of the graph, which tells whether others have changed it.
#include "mapping/facts/fact_units.hpp"

#include <cstring>
#include <string>
#include <string_view>

#include "mapping/damaged_map.hpp"
#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

constexpr std::string_view kStampKey = "facts";
constexpr std::size_t kHashBytes = sizeof(ContentHash::bytes);

std::string keyOf(const FactUnitKey& key) {
  return tables::keyOf(key.id) + static_cast<char>(key.facet);
}

std::string stampOf(const rdf::QuadReader& quads, rdf::TermId graph) {
  const std::uint64_t count = quads.count({.s = {}, .p = {}, .o = {}, .g = graph});
  return {reinterpret_cast<const char*>(&count), sizeof count};
}

[[noreturn]] void failDamaged() {
  refuseDamaged("a stored unit of facts is cut short");
}

std::string bytesOf(const FactUnit& unit) {
  std::string bytes = tables::keyOf(unit.cause);
  bytes.append(reinterpret_cast<const char*>(unit.subjects.data()), unit.subjects.size() * sizeof(rdf::TermId));
  return bytes;
}

FactUnit unitFrom(const FactUnitKey& key, std::string_view bytes) {
  if (bytes.size() < kHashBytes || (bytes.size() - kHashBytes) % sizeof(rdf::TermId) != 0) failDamaged();
  FactUnit unit{key, tables::hashOfKey(bytes), {}};
  bytes.remove_prefix(kHashBytes);
  unit.subjects.resize(bytes.size() / sizeof(rdf::TermId));
  if (!bytes.empty()) std::memcpy(unit.subjects.data(), bytes.data(), bytes.size());
  return unit;
}

}  // namespace

bool haveFactUnits(const rdf::ReadTransaction& transaction, const rdf::QuadReader& quads, rdf::TermId graph) {
  const auto stamp = transaction.block(tables::kMeta, kStampKey);
  return stamp && *stamp == stampOf(quads, graph);
}

void stampFactUnits(rdf::WriteTransaction& transaction, const rdf::QuadReader& quads, rdf::TermId graph) {
  transaction.putBlock(tables::kMeta, kStampKey, stampOf(quads, graph));
}

std::optional<FactUnit> storedFactUnit(const rdf::ReadTransaction& transaction, const FactUnitKey& key) {
  const auto bytes = transaction.block(tables::kFactUnits, keyOf(key));
  return bytes ? std::optional(unitFrom(key, *bytes)) : std::nullopt;
}

std::vector<FactUnitKey> storedFactUnitKeys(const rdf::ReadTransaction& transaction) {
  std::vector<FactUnitKey> keys;
  transaction.forEachBlock(tables::kFactUnits, "", [&](std::string_view key, std::string_view) {
    if (key.size() != kHashBytes + 1) failDamaged();
    keys.push_back({tables::hashOfKey(key), static_cast<Facet>(key.back())});
  });
  return keys;
}

void storeFactUnit(rdf::WriteTransaction& transaction, const FactUnit& unit) {
  transaction.putIfDifferent(tables::kFactUnits, keyOf(unit.key), bytesOf(unit));
}

void eraseFactUnit(rdf::WriteTransaction& transaction, const FactUnitKey& key) {
  transaction.eraseBlock(tables::kFactUnits, keyOf(key));
}

void forgetFactUnits(rdf::WriteTransaction& transaction) {
  transaction.eraseBlock(tables::kMeta, kStampKey);
}

}  // namespace cluxel::mapping
