// SPDX-License-Identifier: Apache-2.0
// One block of rows, stamped with the commit that they are of.
#include "mapping/facts/told_ways.hpp"

#include "cluxel/error.hpp"
#include "mapping/build/freed_tiles.hpp"
#include "mapping/map_tables.hpp"
#include "rdf/file/commit_stamps.hpp"

namespace cluxel::mapping {

namespace {

constexpr std::string_view kWaysKey = "ways", kWaysStamp = "facts about ways";
constexpr char kWaysVersion = 1;  ///< of the facts that are told of ways
constexpr std::size_t kWayHashBytes = sizeof(ContentHash::bytes), kWayRowBytes = 2 * kWayHashBytes + 1;

}  // namespace

void storeToldWays(rdf::WriteTransaction& transaction, const std::vector<ToldWay>& ways) {
  std::string bytes(1, kWaysVersion);
  for (const ToldWay& way : ways)
    bytes += tables::keyOf(way.cause) + tables::keyOf(way.name) + static_cast<char>(way.kind);
  transaction.putIfDifferent(tables::kMeta, kWaysKey, bytes);
  rdf::stampCommit(transaction, kWaysStamp);
}

void keepToldWays(rdf::WriteTransaction& transaction) {
  if (rdf::hasStamp(transaction, kWaysStamp)) rdf::stampCommit(transaction, kWaysStamp);
  keepFreedTiles(transaction);
}

std::optional<std::vector<ToldWay>> storedToldWays(const rdf::ReadTransaction& transaction) {
  if (!rdf::hasStamp(transaction, kWaysStamp)) return std::nullopt;
  const auto stored = transaction.block(tables::kMeta, kWaysKey);
  if (!stored || stored->empty() || stored->front() != kWaysVersion) return std::nullopt;
  const std::string_view rows = stored->substr(1);
  if (rows.size() % kWayRowBytes != 0)
    throw Error(ErrorKind::StoreUnavailable, "the list of ways with facts is malformed; build the map anew");
  std::vector<ToldWay> ways;
  for (std::size_t at = 0; at < rows.size(); at += kWayRowBytes) {
    const std::string_view row = rows.substr(at, kWayRowBytes);
    ways.push_back({tables::hashOfKey(row), tables::hashOfKey(row.substr(kWayHashBytes)),
                    static_cast<WayKind>(static_cast<std::uint8_t>(row.back()))});
  }
  return ways;
}

}  // namespace cluxel::mapping
