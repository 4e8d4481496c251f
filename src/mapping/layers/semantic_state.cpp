// SPDX-License-Identifier: Apache-2.0
// One block of numbers.
#include "mapping/layers/semantic_state.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <string>

#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

constexpr std::string_view kStateKey = "semantic state";
constexpr std::size_t kHashBytes = sizeof(ContentHash::bytes);

struct CloudRow {
  ContentHash id, content;
  std::array<double, 6> rays{};  ///< smallest and largest x, y, z
  double time_s = 0;
  std::uint64_t has = 0;  ///< bit 0: a time; 1: a pose
};
static_assert(sizeof(CloudRow) == 96);
struct StateCounts {
  std::uint64_t cluxels = 0, primitives = 0, objects = 0, statements = 0;
};

ContentHash contentOf(const Cloud& cloud) {
  const Eigen::Matrix4d pose = cloud.T_map_sensor.matrix();
  ContentHasher hasher;
  hasher.add(cloud.has_pose).addBytes(pose.data(), 16 * sizeof(double));
  for (const Eigen::Vector3d* corner : {&cloud.min, &cloud.max}) hasher.addBytes(corner->data(), 3 * sizeof(double));
  hasher.add(cloud.point_count);
  for (const Eigen::Vector3d& corner : {cloud.rays.min(), cloud.rays.max()})
    hasher.addBytes(corner.data(), 3 * sizeof(double));
  return hasher.finish();
}

}  // namespace

void storeSemanticState(rdf::WriteTransaction& transaction, const SemanticState& state) {
  const StateCounts counts{state.cluxels, state.primitives, state.objects, state.statements.size()};
  std::string bytes(reinterpret_cast<const char*>(&counts), sizeof counts);
  for (const ContentHash& statement : state.statements) bytes += tables::keyOf(statement);
  for (const SeenCloud& cloud : state.clouds) {
    const Eigen::Vector3d low = cloud.rays.min(), high = cloud.rays.max();
    const CloudRow row{cloud.id,
                       cloud.content,
                       {low.x(), low.y(), low.z(), high.x(), high.y(), high.z()},
                       cloud.time_s.value_or(0),
                       (cloud.time_s ? 1U : 0U) + (cloud.has_pose ? 2U : 0U)};
    bytes.append(reinterpret_cast<const char*>(&row), sizeof row);
  }
  transaction.putBlock(tables::kMeta, kStateKey, bytes);
}

std::optional<SemanticState> storedSemanticState(const rdf::ReadTransaction& transaction) {
  const auto stored = transaction.block(tables::kMeta, kStateKey);
  if (!stored || stored->size() < sizeof(StateCounts)) return std::nullopt;
  StateCounts counts;
  std::memcpy(&counts, stored->data(), sizeof counts);
  std::string_view bytes = stored->substr(sizeof counts);
  if (counts.statements > bytes.size() / kHashBytes) return std::nullopt;
  SemanticState state{counts.cluxels, counts.primitives, counts.objects, {}, {}};
  for (std::uint64_t i = 0; i < counts.statements; ++i)
    state.statements.push_back(tables::hashOfKey(bytes.substr(i * kHashBytes, kHashBytes)));
  bytes.remove_prefix(counts.statements * kHashBytes);
  if (bytes.size() % sizeof(CloudRow) != 0) return std::nullopt;
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(CloudRow)) {
    CloudRow row;
    std::memcpy(&row, bytes.data() + at, sizeof row);
    const auto& [x0, y0, z0, x1, y1, z1] = row.rays;
    state.clouds.push_back({row.id,
                            row.content,
                            (row.has & 1U) != 0 ? std::optional(row.time_s) : std::nullopt,
                            (row.has & 2U) != 0,
                            {Eigen::Vector3d(x0, y0, z0), Eigen::Vector3d(x1, y1, z1)}});
  }
  return state;
}

std::vector<SeenCloud> seenClouds(const std::vector<Cloud>& clouds) {
  std::vector<SeenCloud> seen;
  for (const Cloud& cloud : clouds)
    seen.push_back({cloud.id, contentOf(cloud), cloud.time_s, cloud.has_pose, cloud.rays});
  std::sort(seen.begin(), seen.end(), [](const SeenCloud& a, const SeenCloud& b) { return a.id < b.id; });
  return seen;
}

bool areSame(const std::vector<SeenCloud>& a, const std::vector<SeenCloud>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const SeenCloud& left, const SeenCloud& right) {
    return left.id == right.id && left.content == right.content && left.time_s == right.time_s;
  });
}

bool haveSameSources(const SemanticState& a, const SemanticState& b) {
  return a.statements == b.statements && areSame(a.clouds, b.clouds);
}

bool haveOtherTimes(const std::vector<SeenCloud>& before, const std::vector<SeenCloud>& now) {
  std::map<ContentHash, std::optional<double>> times;
  for (const SeenCloud& cloud : before) times.emplace(cloud.id, cloud.time_s);
  return std::any_of(now.begin(), now.end(), [&](const SeenCloud& cloud) {
    const auto known = times.find(cloud.id);
    return known != times.end() && known->second != cloud.time_s;
  });
}

bool tellsPresence(const std::vector<SeenCloud>& clouds) {
  return std::count_if(clouds.begin(), clouds.end(),
                       [](const SeenCloud& cloud) { return cloud.time_s && cloud.has_pose; }) >= 2;
}

std::vector<Eigen::AlignedBox3d> changedRays(const std::vector<SeenCloud>& before, const std::vector<SeenCloud>& now) {
  const auto missingIn = [](const std::vector<SeenCloud>& from, const std::vector<SeenCloud>& in, auto& boxes) {
    std::map<ContentHash, ContentHash> contents;
    for (const SeenCloud& cloud : in) contents.emplace(cloud.id, cloud.content);
    for (const SeenCloud& cloud : from)
      if (const auto same = contents.find(cloud.id); same == contents.end() || same->second != cloud.content)
        boxes.push_back(cloud.rays);
  };
  std::vector<Eigen::AlignedBox3d> boxes;
  missingIn(before, now, boxes);
  missingIn(now, before, boxes);
  return boxes;
}

}  // namespace cluxel::mapping
