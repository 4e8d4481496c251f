// SPDX-License-Identifier: Apache-2.0
// Clouds are not in an order of places, and each lies in several regions. So each region answers for its points of all
// clouds, and a cloud's answers are put together from these pieces.
#include "mapping/regions/answered_clouds.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include "base/free_memory.hpp"
#include "base/sorting/temporary_bytes.hpp"
#include "mapping/build/cluxel_finder.hpp"
#include "mapping/build/tile_stages.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/regions/tile_objects.hpp"
#include "mapping/regions/tile_regions.hpp"
#include "mapping/stored_grid.hpp"
#include "perception/crf/labelling.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

/// Answers for some points of a cloud. The arrays are parallel.
struct AnswerPiece {
  std::vector<std::uint32_t> point;  ///< number in the cloud, ascending
  PointAnswers answers;

  void add(std::size_t number, std::uint32_t cluxel, std::uint8_t label, std::uint32_t object) {
    point.push_back(static_cast<std::uint32_t>(number));
    answers.cluxel.push_back(cluxel);
    answers.label.push_back(label);
    answers.object.push_back(object);
  }
  void addTo(LabelledPoints& labelled) const {
    for (std::size_t i = 0; i < point.size(); ++i) labelled.emplace_back(point[i], answers.label[i]);
  }
};

/// What the map says about the cluxels of one tile.
struct AnsweringTile {
  CluxelFinder finder;
  perception::LabelTile labels;
  std::vector<std::uint32_t> object;  ///< by cluxel: number in MapReader::objects(), or kNoObjectOfPoint
  std::uint32_t first_cluxel;         ///< in MapReader::scene()
};

class RegionAnswers {
 public:
  RegionAnswers(const MapReader& map, TileStages& stages, const TileSet& tiles,
                const std::map<TileKey, std::uint32_t>& first_cluxel)
      : grid_(storedGrid(map.transaction())) {
    stages.dropPoints();
    stages.loadPoints(map.transaction(), tiles);
    for (const TileKey& tile : tiles) {
      const std::string_view labels = requiredBlock(map.transaction(), tables::kLabels, tile);
      AnsweringTile answering{{grid_, stages, tile, map.model().perception.thin},
                              ofTile(tile, perception::labelTileFromBytes(labels)),
                              objectsInTile(map, tile),
                              first_cluxel.at(tile)};
      const std::size_t count = stages.cluxels().at(tile).size();
      if (answering.labels.label.size() != count || answering.object.size() != count)
        refuseDamaged("a stored tile does not fit its cluxels");
      tiles_.emplace(tile, std::move(answering));
    }
  }

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
  std::map<TileKey, AnsweringTile> tiles_;
};

/// Keeps the pieces of all clouds in a file.
class AnswerPieces {
 public:
  void add(const Cloud& cloud, const AnswerPiece& piece) {
    if (piece.point.empty()) return;
    const PointAnswers& answers = piece.answers;
    std::string bytes;
    append(bytes, piece.point), append(bytes, answers.cluxel), append(bytes, answers.object);
    append(bytes, answers.label);
    places_[cloud.id].push_back({file_.append(bytes), piece.point.size()});
  }

  /// The pieces must have all points of the cloud, each once.
  PointAnswers join(const Cloud& cloud, std::size_t count) const {
    PointAnswers all{std::vector<std::uint32_t>(count), std::vector<std::uint8_t>(count),
                     std::vector<std::uint32_t>(count)};
    std::size_t joined = 0;
    forEachPiece(cloud, [&](const AnswerPiece& piece) {
      for (std::size_t i = 0; i < piece.point.size(); ++i) {
        all.cluxel.at(piece.point[i]) = piece.answers.cluxel[i];
        all.label[piece.point[i]] = piece.answers.label[i];
        all.object[piece.point[i]] = piece.answers.object[i];
      }
      joined += piece.point.size();
    });
    if (joined != count) refuseDamaged(cloud.source + ": has points in tiles that are not there");
    return all;
  }

  /// The points of the pieces, ascending, with their labels.
  LabelledPoints labelled(const Cloud& cloud) const {
    LabelledPoints all;
    forEachPiece(cloud, [&](const AnswerPiece& piece) { piece.addTo(all); });
    std::sort(all.begin(), all.end());
    return all;
  }

 private:
  struct Place {
    std::uint64_t begin = 0;
    std::size_t count = 0;
  };

  template <typename T>
  static void append(std::string& bytes, const std::vector<T>& values) {
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }

  template <typename Visit>
  void forEachPiece(const Cloud& cloud, const Visit& visit) const {
    if (const auto places = places_.find(cloud.id); places != places_.end())
      for (const Place& place : places->second) visit(read(place));
  }

  AnswerPiece read(const Place& place) const {
    AnswerPiece piece;
    std::uint64_t at = place.begin;
    const auto take = [&](auto& values) {
      values.resize(place.count);
      const std::size_t bytes = values.size() * sizeof(values[0]);
      file_.read(at, reinterpret_cast<char*>(values.data()), bytes);
      at += bytes;
    };
    take(piece.point), take(piece.answers.cluxel), take(piece.answers.object), take(piece.answers.label);
    return piece;
  }

  TemporaryBytes file_;
  std::unordered_map<scan::ScanId, std::vector<Place>> places_;
};

/// Clouds and the tiles in which their points are answered for, cut into regions.
class AnsweredClouds {
 public:
  AnsweredClouds(const MapReader& map, std::vector<Cloud> clouds, const TileSet& wanted, std::size_t max_cluxels)
      : map_(map),
        clouds_(std::move(clouds)),
        grid_(storedGrid(map.transaction())),
        inputs_(map.inputs()),
        stages_(map.model(), inputs_.params) {
    std::vector<CountedTile> tiles;
    std::uint32_t first = 0;
    for (const TileKey& tile : storedTiles(map.transaction())) {
      const std::size_t count = perception::cluxelsIn(requiredBlock(map.transaction(), tables::kSummaries, tile));
      first_cluxel_.emplace(tile, first);
      first += static_cast<std::uint32_t>(count);
      if (wanted.contains(tile)) tiles.push_back({tile, count});
    }
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

  /// `only`: as RegionAnswers::answersFor() has it.
  void collect(std::optional<std::uint32_t> only) {
    for (const TileSet& region : regions_) {
      const RegionAnswers answers(map_, stages_, region, first_cluxel_);
      for (const Cloud& cloud : clouds_)
        if (meets(cloud, region)) pieces_.add(cloud, answers.answersFor(cloud, map_.pointsOf(cloud.id), only));
    }
    stages_.dropAll();
    returnFreeMemory();
  }

  void visitObjectInOneRegion(std::uint32_t object, const ObjectPointsVisit& visit) {
    const RegionAnswers answers(map_, stages_, regions_.front(), first_cluxel_);
    for (const Cloud& cloud : clouds_) {
      if (!meets(cloud, regions_.front())) continue;
      const scan::ScanPoints points = map_.pointsOf(cloud.id);
      LabelledPoints labelled;
      answers.answersFor(cloud, points, object).addTo(labelled);
      if (!labelled.empty()) visit(cloud, points, labelled);
    }
  }

  void visitOneRegion(const AnsweredVisit& visit) {
    const RegionAnswers answers(map_, stages_, regions_.front(), first_cluxel_);
    for (const Cloud& cloud : clouds_) {
      const scan::ScanPoints points = map_.pointsOf(cloud.id);
      const AnswerPiece piece = answers.answersFor(cloud, points);
      if (piece.point.size() != points.size()) refuseDamaged(cloud.source + ": has points in tiles that are not there");
      visit(cloud, points, piece.answers);
    }
  }

  const MapReader& map_;
  std::vector<Cloud> clouds_;
  perception::TileGrid grid_;
  MapInputs inputs_;
  TileStages stages_;
  std::map<TileKey, std::uint32_t> first_cluxel_;
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
  const std::optional<ObjectRecord> record = storedRecord(map.transaction(), map.objectIds().at(object));
  if (!record) refuseDamaged("an object is not there");
  const TileSet tiles(record->tiles.begin(), record->tiles.end());
  AnsweredClouds(map, map.clouds(), tiles, max_cluxels).visitObject(object, visit);
}

}  // namespace cluxel::mapping
