// SPDX-License-Identifier: Apache-2.0
// A stored presence is found by a hash of all that it follows from.
#include "mapping/presence/stored_presence.hpp"

#include <array>
#include <cstring>
#include <string>

#include "base/content_hash.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/presence/object_rows.hpp"

namespace cluxel::mapping {

namespace {

using MaybePresence = std::optional<perception::Presence>;

/// The version of the computation of presence from rays. A new number invalidates every stored presence.
constexpr std::uint32_t kVersion = 8;

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

MaybePresence presenceOf(const Row& row) {
  if ((row.has & 1U) == 0) return std::nullopt;
  perception::Presence presence{row.times[0], row.times[1], {}, {}};
  if ((row.has & 2U) != 0) presence.seen_empty_s = row.times[2];
  if ((row.has & 4U) != 0) presence.seen_through_s = row.times[3];
  return presence;
}

std::optional<Row> rowFrom(std::string_view bytes) {
  if (bytes.size() != sizeof(Row)) return std::nullopt;
  Row row;
  std::memcpy(&row, bytes.data(), sizeof row);
  return row;
}

std::optional<Row> storedRow(const rdf::ReadTransaction& transaction, const ContentHash& object) {
  const auto bytes = transaction.block(tables::kPresence, tables::keyOf(object));
  return bytes ? rowFrom(*bytes) : std::nullopt;
}

/// The hash of what a cloud's rays say: its points are named by its id.
ContentHash hashOf(const Cloud& cloud) {
  const Eigen::Matrix4d pose = cloud.T_map_sensor.matrix();
  return ContentHasher().add(cloud.id).add(*cloud.time_s).addBytes(pose.data(), sizeof(double) * 16).finish();
}

}  // namespace

PresenceUpdate::PresenceUpdate(const rdf::ReadTransaction& transaction, std::span<const RayTarget> targets,
                               const std::vector<Cloud>& clouds, unsigned threads)
    : causes_(targets.size()), presence_(targets.size()) {
  for (const RayTarget& target : targets) ids_.push_back(target.object);
  const std::vector<const Cloud*> timed = timedClouds(clouds);
  is_told_ = timed.size() >= 2;
  if (!is_told_) return;
  std::vector<ContentHash> cloud_hash;
  for (const Cloud* cloud : timed) cloud_hash.push_back(hashOf(*cloud));
  std::vector<std::span<const perception::Place>> asked;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const std::span<const perception::Place> places = targets[i].places;
    if (places.empty()) continue;  // the ground: it has no row
    const Eigen::AlignedBox3d box = boxAround(places);
    ContentHasher hasher;
    hasher.add(kVersion).addBytes(places.data(), places.size_bytes());
    for (std::size_t c = 0; c < timed.size(); ++c)
      if (mayPass(*timed[c], places, box)) hasher.add(cloud_hash[c]);
    causes_[i] = hasher.finish();
    if (const auto row = storedRow(transaction, ids_[i]); row && row->cause == *causes_[i]) {
      presence_[i] = presenceOf(*row);
    } else {
      unknown_.push_back(i);
      asked.push_back(places);
    }
  }
  if (!asked.empty()) voting_.emplace(std::move(asked), clouds, threads);
}

std::vector<ContentHash> objectsSeenThrough(const rdf::ReadTransaction& transaction) {
  std::vector<ContentHash> gone;
  transaction.forEachBlock(tables::kPresence, "", [&](std::string_view key, std::string_view bytes) {
    const std::optional<Row> row = rowFrom(bytes);
    if (!row) return;
    if (const MaybePresence presence = presenceOf(*row); presence && presence->seen_through_s)
      gone.push_back(tables::hashOfKey(key));
  });
  return gone;
}

std::vector<MaybePresence> PresenceUpdate::finish(rdf::WriteTransaction& transaction, Covered covered) {
  if (voting_) {
    const std::vector<MaybePresence> computed = presenceFrom(voting_->finish());
    for (std::size_t u = 0; u < unknown_.size(); ++u) presence_[unknown_[u]] = computed[u];
  }
  if (covered == Covered::All)
    eraseRowsBut(transaction, tables::kPresence, is_told_ ? ids_ : std::vector<ContentHash>{});
  for (std::size_t i = 0; i < presence_.size(); ++i) {
    if (!causes_[i]) continue;
    const Row row = rowOf(*causes_[i], presence_[i]);
    putRow(transaction, tables::kPresence, ids_[i], {reinterpret_cast<const char*>(&row), sizeof row});
  }
  return std::move(presence_);
}

}  // namespace cluxel::mapping
