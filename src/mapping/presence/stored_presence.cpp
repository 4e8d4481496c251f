// SPDX-License-Identifier: Apache-2.0
// A stored presence is found by a hash of all that it follows from.
#include "mapping/presence/stored_presence.hpp"

#include <array>
#include <cstring>
#include <map>
#include <string>

#include "base/content_hash.hpp"
#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

using MaybePresence = std::optional<perception::Presence>;

constexpr std::string_view kKey = "presence";
/// The version of the computation of presence from rays. A new number invalidates every stored presence.
constexpr std::uint32_t kVersion = 2;

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

PresenceUpdate::PresenceUpdate(const rdf::ReadTransaction& transaction, const perception::Scene& scene,
                               std::span<const rules::SemanticObject> objects, const std::vector<Cloud>& clouds,
                               unsigned threads)
    : causes_(objects.size()), presence_(objects.size()) {
  const std::vector<const Cloud*> timed = timedClouds(clouds);
  is_told_ = timed.size() >= 2;
  if (!is_told_) return;
  std::vector<ContentHash> cloud_hash;
  for (const Cloud* cloud : timed) cloud_hash.push_back(hashOf(*cloud));
  const std::map<ContentHash, MaybePresence> known = storedPresence(transaction);
  std::vector<rules::SemanticObject> asked;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const std::vector<Eigen::Vector3d> places = placesOn(scene, objects[i]);
    ContentHasher hasher;
    hasher.add(kVersion).addBytes(places.data(), places.size() * sizeof(Eigen::Vector3d));
    for (std::size_t c = 0; c < timed.size() && !places.empty(); ++c)
      if (mayPass(*timed[c], places)) hasher.add(cloud_hash[c]);
    causes_[i] = hasher.finish();
    if (const auto found = known.find(causes_[i]); found != known.end()) {
      presence_[i] = found->second;
    } else if (!places.empty()) {
      unknown_.push_back(i);
      asked.push_back(objects[i]);
    }
  }
  if (!asked.empty()) voting_.emplace(scene, asked, clouds, threads);
}

std::vector<MaybePresence> PresenceUpdate::finish(rdf::WriteTransaction& transaction) {
  if (!is_told_) {
    transaction.eraseBlock(tables::kMeta, kKey);
    return std::move(presence_);
  }
  if (voting_) {
    const std::vector<MaybePresence> computed = presenceOfObjects(voting_->finish());
    for (std::size_t u = 0; u < unknown_.size(); ++u) presence_[unknown_[u]] = computed[u];
  }
  std::vector<Row> rows;
  for (std::size_t i = 0; i < presence_.size(); ++i) rows.push_back(rowOf(causes_[i], presence_[i]));
  transaction.putBlock(tables::kMeta, kKey, {reinterpret_cast<const char*>(rows.data()), rows.size() * sizeof(Row)});
  return std::move(presence_);
}

}  // namespace cluxel::mapping
