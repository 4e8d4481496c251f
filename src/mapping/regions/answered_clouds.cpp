// SPDX-License-Identifier: Apache-2.0
// Clouds are not in an order of places, and each lies in several regions. So each region answers for its points of all
// clouds, and a cloud's answers are put together from these pieces.
#include "mapping/regions/answered_clouds.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/free_memory.hpp"
#include "mapping/build/cluxel_finder.hpp"
#include "mapping/build/tile_stages.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/regions/answer_pieces.hpp"
#include "mapping/regions/recent_tiles.hpp"
#include "mapping/regions/tile_objects.hpp"
#include "mapping/regions/tile_regions.hpp"
#include "mapping/stored_grid.hpp"
#include "perception/crf/labelling.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

/// What the map says about the cluxels of one tile.
struct AnsweringTile {
  CluxelFinder finder;
  perception::LabelTile labels;
  std::vector<std::uint32_t> object;  ///< by cluxel: number in MapReader::objects(), or kNoObjectOfPoint
  std::uint32_t first_cluxel;         ///< in MapReader::scene()
};

CluxelRanges cluxelRangesOf(const MapReader& map) {
  CluxelRanges ranges;
  std::uint32_t first = 0;
  for (const TileKey& tile : storedTiles(map.transaction())) {
    const std::size_t count = perception::cluxelsIn(requiredBlock(map.transaction(), tables::kSummaries, tile));
    ranges.emplace(tile, CluxelRange{first, count});
    first += static_cast<std::uint32_t>(count);
  }
  return ranges;
}

class RegionAnswers {
 public:
  RegionAnswers(const perception::TileGrid& grid, const perception::ThinParams& thin) : grid_(grid), thin_(thin) {}

  /// Reads tiles that are not there. Their points stay in `stages`, for as long as the tiles are here.
  void add(const MapReader& map, TileStages& stages, const TileSet& tiles, const CluxelRanges& ranges) {
    stages.loadPoints(map.transaction(), tiles);
    for (const TileKey& tile : tiles) {
      const std::string_view labels = requiredBlock(map.transaction(), tables::kLabels, tile);
      AnsweringTile answering{{grid_, stages, tile, thin_},
                              ofTile(tile, perception::labelTileFromBytes(labels)),
                              objectsInTile(map, tile),
                              ranges.at(tile).first};
      const std::size_t count = stages.cluxels().at(tile).size();
      if (answering.labels.label.size() != count || answering.object.size() != count)
        refuseDamaged("a stored tile does not fit its cluxels");
      tiles_.emplace(tile, std::move(answering));
    }
  }
  /// Moves tiles to the answers that are returned.
  RegionAnswers take(const TileSet& tiles) {
    RegionAnswers taken(grid_, thin_);
    for (const TileKey& tile : tiles) taken.tiles_.insert(tiles_.extract(tile));
    return taken;
  }
  void giveBack(RegionAnswers taken) { tiles_.merge(taken.tiles_); }
  void clear() { tiles_.clear(); }

  /// `only`: absent, or the number of the object whose points are wanted.
  AnswerPiece answersFor(const Cloud& cloud, const scan::ScanPoints& points,
                         std::optional<std::uint32_t> only = std::nullopt) const {
    AnswerPiece piece;
    auto tile = tiles_.end();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d p_map = scan::toMap(cloud.T_map_sensor, {points.x[i], points.y[i], points.z[i]});
      const TileKey key = grid_.tileOf(p_map);
      if (tile == tiles_.end() || tile->first != key) tile = tiles_.find(key);
      if (tile == tiles_.end()) continue;
      const AnsweringTile& here = tile->second;
      const std::uint32_t cluxel = here.finder.cluxelOf(p_map);
      if (only && here.object.at(cluxel) != *only) continue;
      piece.add(i, here.first_cluxel + cluxel, here.labels.label.at(cluxel), here.object.at(cluxel));
    }
    return piece;
  }

 private:
  perception::TileGrid grid_;
  perception::ThinParams thin_;
  std::map<TileKey, AnsweringTile> tiles_;
};

void visitObjectIn(const TileSet& tiles, const RegionAnswers& answers, const MapReader& map,
                   const std::vector<Cloud>& clouds, std::uint32_t object, const ObjectPointsVisit& visit) {
  const perception::TileGrid grid = storedGrid(map.transaction());
  for (const Cloud& cloud : clouds) {
    if (tilesInBounds(cloud, tiles, grid).empty()) continue;
    const scan::ScanPoints points = map.pointsOf(cloud.id);
    LabelledPoints labelled;
    answers.answersFor(cloud, points, object).addTo(labelled);
    if (!labelled.empty()) visit(cloud, points, labelled);
  }
}

/// Clouds and the tiles in which their points are answered for, cut into regions.
class AnsweredClouds {
 public:
  AnsweredClouds(const MapReader& map, std::vector<Cloud> clouds, const TileSet& wanted, std::size_t max_cluxels)
      : map_(map),
        clouds_(std::move(clouds)),
        grid_(storedGrid(map.transaction())),
        inputs_(map.inputs()),
        stages_(map.model(), inputs_.params),
        ranges_(cluxelRangesOf(map)) {
    std::vector<CountedTile> tiles;
    for (const auto& [tile, range] : ranges_)
      if (wanted.contains(tile)) tiles.push_back({tile, range.count});
    regions_ = regionsOf(std::move(tiles), max_cluxels);
  }

  void visitAll(const AnsweredVisit& visit) {
    if (regions_.size() == 1) return visitOneRegion(visit);
    collect(std::nullopt);
    for (const Cloud& cloud : clouds_) {
      const scan::ScanPoints points = map_.pointsOf(cloud.id);
      visit(cloud, points, pieces_.join(cloud, points.size()));
    }
  }

  void visitObject(std::uint32_t object, const ObjectPointsVisit& visit) {
    if (regions_.size() == 1) return visitObjectInOneRegion(object, visit);
    collect(object);
    for (const Cloud& cloud : clouds_)
      if (const LabelledPoints labelled = pieces_.labelled(cloud); !labelled.empty())
        visit(cloud, map_.pointsOf(cloud.id), labelled);
  }

 private:
  bool meets(const Cloud& cloud, const TileSet& region) const { return !tilesInBounds(cloud, region, grid_).empty(); }

  RegionAnswers answersIn(const TileSet& region) {
    stages_.dropPoints();
    RegionAnswers answers(grid_, map_.model().perception.thin);
    answers.add(map_, stages_, region, ranges_);
    return answers;
  }

  /// `only`: as RegionAnswers::answersFor() has it.
  void collect(std::optional<std::uint32_t> only) {
    for (const TileSet& region : regions_) {
      const RegionAnswers answers = answersIn(region);
      for (const Cloud& cloud : clouds_)
        if (meets(cloud, region)) pieces_.add(cloud, answers.answersFor(cloud, map_.pointsOf(cloud.id), only));
    }
    stages_.dropAll();
    returnFreeMemory();
  }

  void visitObjectInOneRegion(std::uint32_t object, const ObjectPointsVisit& visit) {
    visitObjectIn(regions_.front(), answersIn(regions_.front()), map_, clouds_, object, visit);
  }

  void visitOneRegion(const AnsweredVisit& visit) {
    const RegionAnswers answers = answersIn(regions_.front());
    for (const Cloud& cloud : clouds_) {
      const scan::ScanPoints points = map_.pointsOf(cloud.id);
      const AnswerPiece piece = answers.answersFor(cloud, points);
      if (piece.point.size() != points.size()) refuseOutside(cloud);
      visit(cloud, points, piece.answers);
    }
  }

  const MapReader& map_;
  std::vector<Cloud> clouds_;
  perception::TileGrid grid_;
  MapInputs inputs_;
  TileStages stages_;
  CluxelRanges ranges_;
  std::vector<TileSet> regions_;
  AnswerPieces pieces_;
};

/// Those in which the clouds may have points.
TileSet tilesUnder(const MapReader& map, const std::vector<Cloud>& clouds) {
  const TileSet all = storedTiles(map.transaction());
  const perception::TileGrid grid = storedGrid(map.transaction());
  TileSet tiles;
  for (const Cloud& cloud : clouds) tiles.merge(tilesInBounds(cloud, all, grid));
  return tiles;
}

TileSet tilesOfObject(const MapReader& map, std::uint32_t object) {
  const std::optional<ObjectRecord> record = storedRecord(map.transaction(), map.objectIds().at(object));
  if (!record) refuseDamaged("an object is not there");
  return {record->tiles.begin(), record->tiles.end()};
}

}  // namespace

void forEachAnsweredCloud(const MapReader& map, const AnsweredVisit& visit, std::size_t max_cluxels) {
  forEachAnsweredCloud(map, map.clouds(), visit, max_cluxels);
}

void forEachAnsweredCloud(const MapReader& map, std::vector<Cloud> clouds, const AnsweredVisit& visit,
                          std::size_t max_cluxels) {
  const TileSet tiles = tilesUnder(map, clouds);
  AnsweredClouds(map, std::move(clouds), tiles, max_cluxels).visitAll(visit);
}

void forEachCloudOfObject(const MapReader& map, std::uint32_t object, const ObjectPointsVisit& visit,
                          std::size_t max_cluxels) {
  AnsweredClouds(map, map.clouds(), tilesOfObject(map, object), max_cluxels).visitObject(object, visit);
}

class KeptAnswers::Impl {
 public:
  Impl(const MapReader& map, std::size_t max_cluxels)
      : max_cluxels_(max_cluxels),
        commit_(commitOf(map)),
        model_(map.model()),
        stages_(model_, map.inputs().params),
        recent_(cluxelRangesOf(map), max_cluxels),
        answers_(storedGrid(map.transaction()), model_.perception.thin) {}

  bool isOf(const MapReader& map) const { return map.quads().kept(kCommit) == commit_; }

  PointAnswers answersFor(const MapReader& map, const Cloud& cloud, const scan::ScanPoints& points) {
    PointAnswers found;
    if (hold(map, tilesUnder(map, {cloud}))) {
      AnswerPiece piece = answers_.answersFor(cloud, points);
      if (piece.point.size() != points.size()) refuseOutside(cloud);
      found = std::move(piece.answers);
    } else {
      clear();  // a region takes as much again
      const auto take = [&](const auto&, const auto&, const PointAnswers& answers) { found = answers; };
      forEachAnsweredCloud(map, {cloud}, take, max_cluxels_);
    }
    return found;
  }

  void forEachCloud(const MapReader& map, std::uint32_t object, const ObjectPointsVisit& visit) {
    const TileSet tiles = tilesOfObject(map, object);
    if (!hold(map, tiles)) return clear(), forEachCloudOfObject(map, object, visit, max_cluxels_);
    RegionAnswers own = answers_.take(tiles);  // points in other tiles need not be found
    try {
      visitObjectIn(tiles, own, map, map.clouds(), object, visit);
    } catch (...) {
      clear();
      throw;
    }
    answers_.giveBack(std::move(own));
  }

 private:
  static constexpr const char* kCommit = "kept answers";

  /// What the readers of a commit share, as long as somebody has it.
  static std::shared_ptr<const void> commitOf(const MapReader& map) {
    if (!map.quads().kept(kCommit)) map.quads().keep(kCommit, std::make_shared<int>());
    return map.quads().kept(kCommit);
  }

  /// Reads the tiles that are missing. False when these are too many to be kept.
  bool hold(const MapReader& map, const TileSet& tiles) {
    const auto change = recent_.use(tiles);
    if (!change) return false;
    answers_.take(change->dropped);
    stages_.dropPoints(change->dropped);
    try {
      if (!change->read.empty()) answers_.add(map, stages_, change->read, recent_.ranges());
    } catch (...) {
      clear();
      throw;
    }
    return true;
  }

  void clear() {
    recent_.clear(), answers_.clear();
    stages_.dropAll();
  }

  std::size_t max_cluxels_;
  std::shared_ptr<const void> commit_;
  perception::LabelModel model_;
  TileStages stages_;
  RecentTiles recent_;
  RegionAnswers answers_;
};

KeptAnswers::KeptAnswers(const MapReader& map, std::size_t max_cluxels)
    : impl_(std::make_unique<Impl>(map, max_cluxels)) {}
KeptAnswers::~KeptAnswers() = default;

bool KeptAnswers::isOf(const MapReader& map) const {
  return impl_->isOf(map);
}
PointAnswers KeptAnswers::answersFor(const MapReader& map, const Cloud& cloud, const scan::ScanPoints& points) {
  return impl_->answersFor(map, cloud, points);
}
void KeptAnswers::forEachCloud(const MapReader& map, std::uint32_t object, const ObjectPointsVisit& visit) {
  impl_->forEachCloud(map, object, visit);
}

}  // namespace cluxel::mapping
