// SPDX-License-Identifier: Apache-2.0
// A stored presence is found by a hash of all that it follows from.
#include "mapping/facts/stored_presence.hpp"

#include <array>
#include <cstring>
#include <map>
#include <string>

#include "base/content_hash.hpp"
#include "mapping/build/scan_store.hpp"
#include "mapping/facts/presence_votes.hpp"
#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

using MaybePresence = std::optional<perception::Presence>;

constexpr std::string_view kKey = "presence";
/// The version of the computation of presence from rays. A new number invalidates every stored presence.
constexpr std::uint32_t kVersion = 1;

/// A row of the stored table.
struct Row {
  ContentHash cause;
  std::array<double, 4> times{};  ///< first and last seen, seen empty, seen through [s]
  std::uint64_t has = 0;          ///< bit 0: there is a presence; 1: seen empty; 2: seen through
};
static_assert(sizeof(Row) == 56);

Row rowOf(const ContentHash& cause, const MaybePresence& presence) {
  Row row{cause, {}, 0};
  if (!presence) return row;
  row.times = {presence->first_seen_s, presence->last_seen_s, presence->seen_empty_s.value_or(0),
               presence->seen_through_s.value_or(0)};
  row.has = 1U + (presence->seen_empty_s ? 2U : 0U) + (presence->seen_through_s ? 4U : 0U);
  return row;
}

MaybePresence presenceFrom(const Row& row) {
  if ((row.has & 1U) == 0) return std::nullopt;
  perception::Presence presence{row.times[0], row.times[1], {}, {}};
  if ((row.has & 2U) != 0) presence.seen_empty_s = row.times[2];
  if ((row.has & 4U) != 0) presence.seen_through_s = row.times[3];
  return presence;
}

std::map<ContentHash, MaybePresence> storedPresence(const rdf::ReadTransaction& transaction) {
  std::map<ContentHash, MaybePresence> known;
  const auto bytes = transaction.block(tables::kMeta, kKey);
  for (std::size_t at = 0; bytes && at + sizeof(Row) <= bytes->size(); at += sizeof(Row)) {
    Row row;
    std::memcpy(&row, bytes->data() + at, sizeof row);
    known.emplace(row.cause, presenceFrom(row));
  }
  return known;
}

/// The hash of what a cloud's rays say: its points are named by its id.
ContentHash hashOf(const Cloud& cloud) {
  const Eigen::Matrix4d pose = cloud.T_map_sensor.matrix();
  return ContentHasher().add(cloud.id).add(*cloud.time_s).addBytes(pose.data(), sizeof(double) * 16).finish();
}

}  // namespace

PresenceUpdate updatePresence(rdf::WriteTransaction& transaction, const perception::Scene& scene,
                              std::span<const rules::SemanticObject> objects, const std::vector<Cloud>& clouds,
                              unsigned threads) {
  PresenceUpdate update;
  update.presence.resize(objects.size());
  const std::vector<const Cloud*> timed = timedClouds(clouds);
  if (timed.size() < 2) {
    transaction.eraseBlock(tables::kMeta, kKey);
    return update;
  }
  std::vector<ContentHash> cloud_hash;
  for (const Cloud* cloud : timed) cloud_hash.push_back(hashOf(*cloud));
  const std::map<ContentHash, MaybePresence> known = storedPresence(transaction);
  std::vector<Row> rows(objects.size());
  std::vector<std::size_t> unknown;
  std::vector<rules::SemanticObject> asked;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const std::vector<Eigen::Vector3d> places = placesOn(scene, objects[i]);
    ContentHasher hasher;
    hasher.add(kVersion).addBytes(places.data(), places.size() * sizeof(Eigen::Vector3d));
    for (std::size_t c = 0; c < timed.size() && !places.empty(); ++c)
      if (mayPass(*timed[c], places)) hasher.add(cloud_hash[c]);
    rows[i].cause = hasher.finish();
    if (const auto found = known.find(rows[i].cause); found != known.end()) {
      update.presence[i] = found->second;
    } else if (!places.empty()) {
      unknown.push_back(i);
      asked.push_back(objects[i]);
    }
  }
  const auto load = [&](const Cloud& cloud) { return storedScan(transaction, cloud.id); };
  const std::vector<MaybePresence> computed = presenceOfObjects(presenceVotes(scene, asked, clouds, load, threads));
  for (std::size_t u = 0; u < unknown.size(); ++u) update.presence[unknown[u]] = computed[u];
  update.computed = unknown.size();
  for (std::size_t i = 0; i < objects.size(); ++i) rows[i] = rowOf(rows[i].cause, update.presence[i]);
  transaction.putBlock(tables::kMeta, kKey, {reinterpret_cast<const char*>(rows.data()), rows.size() * sizeof(Row)});
  return update;
}

}  // namespace cluxel::mapping
