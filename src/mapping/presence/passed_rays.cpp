// SPDX-License-Identifier: Apache-2.0
// Stored counts are found by a hash of all that they follow from.
#include "mapping/presence/passed_rays.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/content_hash.hpp"
#include "base/parallel.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/presence/presence_votes.hpp"

namespace cluxel::mapping {

namespace {

/// The version of the computation. A new number invalidates all stored counts.
constexpr std::uint32_t kCountsVersion = 2;

/// Rays within a decimetre of a place: gaps between bars are not much wider.
constexpr perception::RayParams kThroughParams{.near_m = 0.10, .behind_m = 0.50};

/// A row of the stored table.
struct CountsRow {
  ContentHash cause;
  std::uint64_t ended = 0, passed = 0;
};
static_assert(sizeof(CountsRow) == 32);

std::optional<CountsRow> storedCounts(const rdf::ReadTransaction& transaction, const ContentHash& object) {
  const auto bytes = transaction.block(tables::kPassedRays, tables::keyOf(object));
  if (!bytes || bytes->size() != sizeof(CountsRow)) return std::nullopt;
  CountsRow row;
  std::memcpy(&row, bytes->data(), sizeof row);
  return row;
}

/// The hash of what a cloud's rays say: its points are named by its id.
ContentHash raysHash(const Cloud& cloud) {
  const Eigen::Matrix4d pose = cloud.T_map_sensor.matrix();
  return ContentHasher().add(cloud.id).add(cloud.has_pose).addBytes(pose.data(), sizeof(double) * 16).finish();
}

}  // namespace

PassedRaysUpdate::PassedRaysUpdate(const rdf::ReadTransaction& transaction, std::span<const RayTarget> targets,
                                   const std::vector<Cloud>& clouds, unsigned threads)
    : RayObserver(threads), target_count_(targets.size()) {
  std::vector<ContentHash> hashes;
  for (const Cloud& cloud : clouds) hashes.push_back(raysHash(cloud));
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (targets[i].inner_places.empty()) continue;
    Barrier barrier{i, targets[i].object, targets[i].inner_places, boxAround(targets[i].inner_places), {}, {}};
    std::vector<ContentHash> passing;  // in an order that does not follow that of the clouds
    for (std::size_t c = 0; c < clouds.size(); ++c)
      if (mayPass(clouds[c], barrier.places, barrier.box)) passing.push_back(hashes[c]);
    std::sort(passing.begin(), passing.end());
    ContentHasher hasher;
    hasher.add(kCountsVersion).addBytes(barrier.places.data(), barrier.places.size_bytes());
    for (const ContentHash& hash : passing) hasher.add(hash);
    barrier.cause = hasher.finish();
    barriers_.push_back(barrier);
  }
  for (std::size_t i = 0; i < barriers_.size(); ++i) {
    const std::optional<CountsRow> known = storedCounts(transaction, barriers_[i].id);
    if (known && known->cause == barriers_[i].cause)
      barriers_[i].counts = {known->ended, known->passed};
    else
      unknown_.push_back(i);
  }
}

/// The counts of the barriers that rays of a scan may pass.
class PassedRaysUpdate::View : public ScanView {
 public:
  struct Counted {
    std::size_t barrier = 0;
    perception::RayCounts counts;
  };

  View(const std::vector<Barrier>& barriers, std::vector<Counted> passed)
      : barriers_(barriers), passed_(std::move(passed)) {}

  void look(const perception::ScanRays& rays, unsigned threads) override {
    parallelFor(passed_.size(), threads, [&](std::size_t i) {
      for (const Eigen::Vector3d& place : barriers_[passed_[i].barrier].places)
        passed_[i].counts += rays.countsAt(place, kThroughParams);
    });
  }

  const std::vector<Counted>& passed() const { return passed_; }

 private:
  const std::vector<Barrier>& barriers_;
  std::vector<Counted> passed_;
};

bool PassedRaysUpdate::wants(const Cloud& cloud) const {
  return std::any_of(unknown_.begin(), unknown_.end(),
                     [&](std::size_t i) { return mayPass(cloud, barriers_[i].places, barriers_[i].box); });
}

std::unique_ptr<ScanView> PassedRaysUpdate::view(const Cloud& cloud) const {
  std::vector<View::Counted> passed;
  for (const std::size_t i : unknown_)
    if (mayPass(cloud, barriers_[i].places, barriers_[i].box)) passed.push_back({i, {}});
  return std::make_unique<View>(barriers_, std::move(passed));
}

void PassedRaysUpdate::take(const ScanView& seen) {
  for (const View::Counted& counted : dynamic_cast<const View&>(seen).passed())
    barriers_[counted.barrier].counts += counted.counts;
}

std::vector<std::optional<perception::RayCounts>> PassedRaysUpdate::finish(rdf::WriteTransaction& transaction,
                                                                           Covered covered) const {
  std::vector<std::optional<perception::RayCounts>> result(target_count_);
  std::vector<ContentHash> counted;
  for (const Barrier& barrier : barriers_) {
    const CountsRow row{barrier.cause, barrier.counts.ended, barrier.counts.passed};
    putRow(transaction, tables::kPassedRays, barrier.id, {reinterpret_cast<const char*>(&row), sizeof row});
    counted.push_back(barrier.id);
    if (barrier.counts.ended + barrier.counts.passed > 0) result[barrier.target] = barrier.counts;
  }
  if (covered == Covered::All) eraseRowsBut(transaction, tables::kPassedRays, std::move(counted));
  return result;
}

}  // namespace cluxel::mapping
