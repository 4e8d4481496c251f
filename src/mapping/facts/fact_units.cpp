// SPDX-License-Identifier: Apache-2.0
// One block: the number of quads of the graph, then the units one after the other.
#include "mapping/facts/fact_units.hpp"

#include <cstring>
#include <string>
#include <string_view>

#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

constexpr std::string_view kKey = "facts";

template <typename Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Takes values from the front of the bytes; false when there are too few.
template <typename Value>
bool take(std::string_view& bytes, Value* values, std::size_t count = 1) {
  if (bytes.size() / sizeof(Value) < count) return false;
  if (count > 0) std::memcpy(values, bytes.data(), count * sizeof(Value));
  bytes.remove_prefix(count * sizeof(Value));
  return true;
}

std::uint64_t quadsOf(const rdf::QuadReader& quads, rdf::TermId graph) {
  return quads.count({.s = {}, .p = {}, .o = {}, .g = graph});
}

}  // namespace

std::optional<std::vector<FactUnit>> storedFactUnits(const rdf::ReadTransaction& transaction,
                                                     const rdf::QuadReader& quads, rdf::TermId graph) {
  const auto block = transaction.block(tables::kMeta, kKey);
  if (!block) return std::nullopt;
  std::string_view bytes = *block;
  std::uint64_t quad_count = 0;
  if (!take(bytes, &quad_count) || quad_count != quadsOf(quads, graph)) return std::nullopt;
  std::vector<FactUnit> units;
  while (!bytes.empty()) {
    FactUnit& unit = units.emplace_back();
    std::uint32_t subjects = 0;
    if (!take(bytes, &unit.id) || !take(bytes, &unit.cause) || !take(bytes, &subjects)) return std::nullopt;
    if (bytes.size() / sizeof(rdf::TermId) < subjects) return std::nullopt;
    unit.subjects.resize(subjects);
    take(bytes, unit.subjects.data(), subjects);
  }
  return units;
}

void storeFactUnits(rdf::WriteTransaction& transaction, const std::vector<FactUnit>& units,
                    const rdf::QuadReader& quads, rdf::TermId graph) {
  std::string bytes;
  append(bytes, quadsOf(quads, graph));
  for (const FactUnit& unit : units) {
    append(bytes, unit.id);
    append(bytes, unit.cause);
    append(bytes, static_cast<std::uint32_t>(unit.subjects.size()));
    bytes.append(reinterpret_cast<const char*>(unit.subjects.data()), unit.subjects.size() * sizeof(rdf::TermId));
  }
  transaction.putBlock(tables::kMeta, kKey, bytes);
}

}  // namespace cluxel::mapping
