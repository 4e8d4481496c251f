// SPDX-License-Identifier: Apache-2.0
// Each region is read twice: for its points, and for the rays that pass it. What changed is looked at once more, when
// it is known of the whole map.
#include "tasks/changes/change_survey.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "base/parallel.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/presence/presence_votes.hpp"
#include "mapping/presence/ray_pass.hpp"
#include "mapping/presence/ray_targets.hpp"
#include "mapping/regions/map_regions.hpp"
#include "tasks/changes/changed_parts.hpp"
#include "tasks/changes/kept_cells.hpp"
#include "tasks/changes/kept_cluxels.hpp"

namespace cluxel::tasks {

namespace {

/// Errors of elevation matter less than for objects: connected cluxels must agree, and one in four that a ray would
/// have hit is enough. With such errors 5 of 127 events were missed on seeds 41 to 44 instead of 1.
constexpr perception::RayParams kCluxelRays{.elevation_error_rad = 0};

struct TimedScan {
  const mapping::Cloud& cloud;
  std::size_t time;      ///< kBefore or kAfter
  std::uint32_t number;  ///< by time
};

/// Calls `work(begin, end)` for pieces of [0, count).
template <typename Work>
void inPieces(std::size_t count, unsigned threads, const Work& work) {
  constexpr std::size_t kPiece = 2048;
  parallelFor((count + kPiece - 1) / kPiece, threads,
              [&](std::size_t piece) { work(piece * kPiece, std::min(count, (piece + 1) * kPiece)); });
}

/// The place of a cluxel on the thing that it belongs to.
perception::Place placeIn(const mapping::MapRegion& region, std::uint32_t cluxel) {
  return mapping::rayPlaceOf(region.scene.cluxels, cluxel,
                             [&](std::uint32_t other) { return region.object[other] == region.object[cluxel]; });
}

/// What rays must tell before it is known whether a cluxel changed.
class FirstFindings {
 public:
  FirstFindings(const mapping::MapRegion& region, const std::vector<bool>& wanted) : places_(wanted.size()) {
    for (std::uint32_t i = 0; i < wanted.size(); ++i)
      if (wanted[i]) numbers_.push_back(i), places_[i] = placeIn(region, i);
    for (auto& of_time : found_) of_time.resize(numbers_.size());
  }

  /// A cluxel that was hit at a time needs no more rays of that time.
  void look(const perception::ScanRays& rays, const TimedScan& scan, unsigned threads) {
    std::vector<RayFindings>& found = found_[scan.time];
    inPieces(numbers_.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (!found[i].isHit()) found[i].add(rays.verdictAt(places_[numbers_[i]], kCluxelRays), scan.number);
    });
  }

  RegionFindings take(std::vector<bool> is_told) {
    RegionFindings all{std::move(is_told), std::vector(places_.size(), CluxelChange::Undecided), {}, {}};
    all.gone.resize(places_.size());
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      const std::uint32_t cluxel = numbers_[i];
      all.changes[cluxel] = changeOf(found_[kBefore][i], found_[kAfter][i]);
      all.gone[cluxel] = found_[all.changes[cluxel] == CluxelChange::Vanished ? kAfter : kBefore][i];
    }
    found_ = {};
    all.places = std::move(places_);
    return all;
  }

 private:
  std::vector<perception::Place> places_;  ///< by cluxel; of those that are wanted
  std::vector<std::uint32_t> numbers_;
  std::array<std::vector<RayFindings>, 2> found_;
};

class Survey {
 public:
  Survey(const mapping::MapReader& map, const ComparedTimes& times, std::size_t max_cluxels, unsigned threads)
      : map_(map),
        threads_(threads),
        clouds_(cloudsWithin(map.clouds(), times)),
        leaves_scans_out_(clouds_.size() < map.clouds().size()),
        regions_(map, max_cluxels),
        unread_(regions_.tiles()) {
    std::vector<double> times_s;
    for (const mapping::Cloud* cloud : mapping::timedClouds(clouds_)) {
      times_s.push_back(*cloud->time_s);
      const std::size_t time = *cloud->time_s < times.since_s ? kBefore : kAfter;
      scans_.push_back({*cloud, time, static_cast<std::uint32_t>(scans_.size())});
    }
    survey_.visits = Visits(times_s, times.since_s);
  }

  ChangeSurvey run() {
    for (std::size_t i = 0; i < regions_.size(); ++i) surveyRegion(regions_.read(i));
    std::sort(survey_.states.begin(), survey_.states.end(),
              [](const ObjectStates& a, const ObjectStates& b) { return a.object < b.object; });
    for (std::vector<WholeObject>& of_time : survey_.wholes)
      std::sort(of_time.begin(), of_time.end(),
                [](const WholeObject& a, const WholeObject& b) { return a.object < b.object; });
    KeptCluxels::Clusters clusters = kept_cluxels_.take();
    survey_.cluxels = std::move(clusters.cluxels), survey_.clusters = std::move(clusters.groups);
    survey_.cluxels.visits = survey_.visits;
    for (const std::size_t time : {kBefore, kAfter}) {
      KeptCells::Parts parts = kept_cells_[time].take();
      survey_.cells[time] = std::move(parts.cells), survey_.parts[time] = std::move(parts.groups);
    }
    lookAgain();
    return std::move(survey_);
  }

 private:
  void surveyRegion(const mapping::MapRegion& region) {
    const perception::SceneCluxels& cluxels = region.scene.cluxels;
    std::vector<bool> may_change(cluxels.size()), wanted(cluxels.size());
    for (std::size_t i = 0; i < cluxels.size(); ++i) {
      may_change[i] = region.object[i] == mapping::kNoObject || !regions_.isGround(region.object[i]);
      wanted[i] = may_change[i] && region.is_own[i];
    }
    PointCells cells = cellsIn(region, may_change);
    FirstFindings findings(region, wanted);
    std::vector<std::vector<perception::Place>> places;
    for (const rules::SemanticObject& object : region.objects)
      places.push_back(mapping::placesOn(region.scene, object));
    mapping::PresenceVoting voting({places.begin(), places.end()}, clouds_, threads_);
    for (const TimedScan& scan : scans_) look(region, scan, findings, cells, voting);
    const RegionFindings found = findings.take(std::move(may_change));
    for (const perception::TileKey& tile : region.tiles) unread_.erase(tile);
    keepCluxels(region, found);
    keepCells(region, found.changes, std::move(cells));
    addStates(region, places, voting.finish());
  }

  PointCells cellsIn(const mapping::MapRegion& region, const std::vector<bool>& may_change) {
    CellSums sums(region.scene.cluxels.grid);
    for (const TimedScan& scan : scans_)
      regions_.forEachPoint(region, scan.cloud, [&](const Eigen::Vector3d& p_map, std::uint32_t cluxel, std::size_t) {
        if (may_change[cluxel]) sums.add(scan.time, scan.number, p_map, cluxel);
      });
    return sums.take(region);
  }

  void look(const mapping::MapRegion& region, const TimedScan& scan, FirstFindings& findings, PointCells& cells,
            mapping::PresenceVoting& voting) const {
    const bool votes = voting.wants(scan.cloud);
    if (!votes && !mayPass(scan.cloud, region.scene.cluxels.center)) return;
    const auto view = votes ? voting.view(scan.cloud) : nullptr;
    std::vector<PointCell>& of_other_time = cells[1 - scan.time];
    const perception::ScanRays rays(map_.scanOf(scan.cloud.id));
    findings.look(rays, scan, threads_);
    inPieces(of_other_time.size(), threads_, [&](std::size_t begin, std::size_t end) {
      lookAtCells(rays, scan.number, &PointCell::other, std::span(of_other_time).subspan(begin, end - begin));
    });
    if (!view) return;
    view->look(rays, threads_);
    voting.take(*view);
  }

  void keepCells(const mapping::MapRegion& region, const std::vector<CluxelChange>& changes, PointCells cells) {
    for (const std::size_t time : {kBefore, kAfter}) {
      const CluxelChange kind = time == kBefore ? CluxelChange::Vanished : CluxelChange::Appeared;
      for (PointCell& cell : cells[time]) {
        const auto at = std::lower_bound(region.number.begin(), region.number.end(), cell.cluxel);
        const auto cluxel = static_cast<std::size_t>(at - region.number.begin());
        cell.is_of_changed_cluxel = stateOf(cell) == ChangeState::Changed && changes[cluxel] == kind;
      }
      kept_cells_[time].add(region, std::move(cells[time]), unread_, kept_cluxels_);
    }
  }

  void keepCluxels(const mapping::MapRegion& region, const RegionFindings& found) {
    for (std::size_t i = 0; i < found.changes.size(); ++i)
      if (found.changes[i] == CluxelChange::Stable && region.object[i] != mapping::kNoObject)
        ++survey_.stable_of_object[region.object[i]];
    kept_cluxels_.add(region, found, unread_);
  }

  /// Some scan has hit each place of an object. Where scans are left out of the comparison, all places count as hit, so
  /// that the share of places seen through is the same whatever is compared.
  perception::PlaceSet hitByOthers(std::size_t places) const {
    perception::PlaceSet hit;
    for (std::size_t place = 0; leaves_scans_out_ && place < places; ++place) hit.set(place);
    return hit;
  }

  void addStates(const mapping::MapRegion& region, const std::vector<std::vector<perception::Place>>& places,
                 const std::vector<mapping::ObjectVotes>& votes) {
    for (std::size_t i = 0; i < region.objects.size(); ++i) {
      if (places[i].empty()) continue;
      ObjectStates states =
          statesOf(region.number_of_objects[i], votes[i], survey_.visits, hitByOthers(places[i].size()));
      const auto geometry = mapping::geometryOf(region.scene.cluxels, mapping::cluxelsOf(region.objects[i]));
      states.box = {geometry.min, geometry.max};
      states.centre = geometry.box.center.head<2>();
      survey_.states.push_back(states);
      if (!changedAsWhole(states)) continue;
      WholeObject whole{states.object, mapping::cluxelsOf(region.objects[i]), states.box, states.visits};
      for (std::uint32_t& cluxel : whole.cluxels) cluxel = region.number[cluxel];
      std::sort(whole.cluxels.begin(), whole.cluxels.end());
      survey_.wholes[states.before == perception::PresenceState::Present ? kBefore : kAfter].push_back(
          std::move(whole));
    }
  }

  /// Completes what rays found at cluxels, and in cells of possible parts.
  void lookAgain() {
    PointCells parts;
    std::array<std::vector<std::uint32_t>, 2> numbers;
    for (const std::size_t time : {kBefore, kAfter})
      for (const ChangeGroup& group : survey_.parts[time]) {
        ScanNumbers scans;
        for (const std::uint32_t cell : group) scans |= survey_.cells[time][cell].scans;
        for (const std::uint32_t cell : group) {
          numbers[time].push_back(cell);
          parts[time].push_back(survey_.cells[time][cell]);
          parts[time].back().scans = scans;
        }
      }
    for (const TimedScan& scan : scans_) lookAgain(scan, parts[scan.time]);
    for (const std::size_t time : {kBefore, kAfter})
      for (std::size_t i = 0; i < numbers[time].size(); ++i)
        survey_.cells[time][numbers[time][i]].own = parts[time][i].own;
  }

  /// `scans` of the cells are those of the whole part: visits before the first of them came before the part.
  void lookAgain(const TimedScan& scan, std::vector<PointCell>& parts) {
    ChangedCluxels& all = survey_.cluxels;
    std::vector<RayFindings>& found = scan.time == kBefore ? all.before : all.after;
    if (found.empty() && parts.empty()) return;
    const perception::ScanRays rays(map_.scanOf(scan.cloud.id));
    inPieces(found.size(), threads_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (all.is_told[i]) found[i].add(rays.verdictAt(all.places[i], kCluxelRays), scan.number);
    });
    const std::uint32_t visit = survey_.visits.ofScan(scan.number);
    inPieces(parts.size(), threads_, [&](std::size_t begin, std::size_t end) {
      for (PointCell& cell : std::span(parts).subspan(begin, end - begin))
        if (survey_.visits.ofScan(cell.scans.first()) <= visit)
          lookAtCells(rays, scan.number, &PointCell::own, {&cell, 1});
    });
  }

  const mapping::MapReader& map_;
  unsigned threads_;
  std::vector<mapping::Cloud> clouds_;
  bool leaves_scans_out_;
  mapping::MapRegions regions_;
  std::vector<TimedScan> scans_;
  KeptCluxels kept_cluxels_;
  std::array<KeptCells, 2> kept_cells_;  ///< before and after
  perception::TileSet unread_;           ///< tiles of regions to come
  ChangeSurvey survey_;
};

}  // namespace

std::vector<mapping::Cloud> cloudsWithin(std::vector<mapping::Cloud> clouds, const ComparedTimes& times) {
  std::erase_if(clouds, [&](const mapping::Cloud& cloud) {
    return cloud.time_s && (*cloud.time_s < times.from_s || *cloud.time_s > times.until_s);
  });
  return clouds;
}

ChangeSurvey surveyOf(const mapping::MapReader& map, const ComparedTimes& times, std::size_t max_cluxels,
                      unsigned threads) {
  return Survey(map, times, max_cluxels, threads).run();
}

}  // namespace cluxel::tasks
