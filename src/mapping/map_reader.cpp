// SPDX-License-Identifier: Apache-2.0
// All reads of a MapReader use one snapshot of the file, and share what they read with other readers of its commit.
#include "mapping/map_reader.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include "cluxel/error.hpp"
#include "mapping/build/cluxel_finder.hpp"
#include "mapping/build/way_tiles.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/commit_layers.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_part.hpp"
#include "mapping/map_state.hpp"
#include "rdf/iri.hpp"

namespace cluxel::mapping {

/// The layers are shared with other readers of the commit; transaction and quads are its own.
struct MapReader::Impl {
  std::shared_ptr<rdf::Environment> environment;
  rdf::ReadTransaction transaction;
  rdf::QuadReader quads;
  MapState state;
  std::shared_ptr<CommitLayers> layers;
  HeldStages stages;

  explicit Impl(std::shared_ptr<rdf::Environment> opened)
      : environment(std::move(opened)), transaction(environment->read()), quads(transaction) {
    const auto stored = storedState(transaction);
    if (!stored)
      throw Error(ErrorKind::StoreUnavailable,
                  environment->file().string() + ": holds no map (or its first build never committed); build it");
    state = *stored;
    layers = CommitLayers::of(quads);
  }

  const MapInputs& readInputs() {
    return layers->inputs.get([&] { return storedInputs(transaction); });
  }

  const std::vector<rules::SemanticObject>& readObjects() {
    return layers->objects.get([&] { return storedObjects(transaction); });
  }

  /// The program that built the map accepted this model. A fault now means that another version of Cluxel built the
  /// map, not that the user gave a faulty model.
  perception::LabelModel storedModel() {
    const NamedText& stored = readInputs().model;
    try {
      return perception::parseModel(stored.text, stored.name);
    } catch (const InputError&) {
      refuseOtherVersion(environment->file());
    }
  }

  const perception::LabelModel& readModel() {
    return layers->model.get([&] { return storedModel(); });
  }

  const TileStages& readStages(bool with_points = false) {
    return layers->readStages(transaction, readModel(), readInputs().params, with_points, stages);
  }

  const perception::Scene& readScene() {
    return layers->scene.get([&] {
      if (stages.newest()) return readStages().scene(storedClouds(transaction));
      TileStages only_for_scene(readModel(), readInputs().params);  // as large as the scene
      only_for_scene.load(transaction);
      return only_for_scene.takeScene(storedClouds(transaction));
    });
  }

  const CluxelNumbers& readCluxelNumbers() {
    return layers->cluxel_numbers.get([&] {
      CluxelNumbers numbers;
      std::uint32_t next = 0;
      for (const auto& [key, tile] : readStages().summaries()) {
        numbers.first_of_tile.emplace(key, next);
        next += static_cast<std::uint32_t>(tile.size());
      }
      numbers.object = objectOfCluxel({readObjects(), {}}, next);
      return numbers;
    });
  }

  std::optional<MapPart> partAroundThing(const ThingPlace& thing, const PartSize& size) {
    const perception::TileSet own = tilesOfPrimitives(transaction, thing);
    const perception::TileSet tiles = withRings(own, size.rings);
    const perception::TileSet with_near =
        perception::unionOf(tiles, tilesOfNearObjects(transaction, thing, own, size.near_m));
    if (isLarger(with_near, size)) return std::nullopt;
    std::optional<MapPart> part = partIn(with_near);
    return part ? std::move(part) : partIn(tiles);  // the near objects may be too much of a small map
  }

  std::optional<MapPart> partAroundTile(const perception::TileKey& tile, const PartSize& size) {
    const perception::TileSet tiles = withRings({tile}, size.rings);
    return isLarger(tiles, size) ? std::nullopt : partIn(tiles);
  }

  perception::TileSet withRings(perception::TileSet tiles, int rings) const {
    const perception::TileSet map = storedTiles(transaction);
    for (int ring = 0; ring < rings; ++ring) tiles = perception::withRing(tiles, map);
    return tiles;
  }

  bool isLarger(const perception::TileSet& tiles, const PartSize& size) const {
    return size.most_cluxels && haveMoreCluxels(transaction, tiles, *size.most_cluxels);
  }

  std::optional<MapPart> partIn(const perception::TileSet& tiles) {
    TileStages here(readModel(), readInputs().params);
    return partOfMap(transaction, here, tiles, 0);
  }
};

MapReader::MapReader(const std::filesystem::path& file)
    : impl_(std::make_unique<Impl>(rdf::Environment::open(file, rdf::OpenMode::ReadOnly))) {}
MapReader::~MapReader() = default;
MapReader::MapReader(MapReader&&) noexcept = default;

std::string localName(std::string_view iri) {
  return rdf::localName(iri);
}

MapSummary MapReader::summary() const {
  MapSummary summary;
  summary.is_finished = impl_->state.is_finished;
  summary.inputs_hash = impl_->state.inputs_hash;
  for (const Cloud& cloud : clouds()) {
    ++summary.clouds;
    summary.points += cloud.point_count;
  }
  std::map<std::string, std::size_t> by_iri;
  forEachRecord(impl_->transaction, [&](const ContentHash&, const ObjectRecord& record) {
    ++by_iri[record.class_iri];
    ++summary.objects;
  });
  for (const auto& [iri, count] : by_iri) summary.objects_by_class[classNames().nameOf(iri)] = count;
  summary.quads = impl_->quads.size();
  return summary;
}

bool MapReader::isFinished() const {
  return impl_->state.is_finished;
}

const rdf::ClassNames& MapReader::classNames() const {
  return impl_->layers->class_names.get([&] { return rdf::classNamesOf(impl_->quads); });
}

std::vector<Cloud> MapReader::clouds() const {
  return storedClouds(impl_->transaction);
}
scan::ScanPoints MapReader::pointsOf(const scan::ScanId& cloud) const {
  return storedPoints(impl_->transaction, cloud);
}
scan::Scan MapReader::scanOf(const scan::ScanId& cloud) const {
  return storedScan(impl_->transaction, cloud);
}
const std::vector<ContentHash>& MapReader::objectIds() const {
  return impl_->layers->object_ids.get([&] { return storedObjectIds(impl_->transaction); });
}

const std::vector<ContentHash>& MapReader::primitiveIds() const {
  return impl_->layers->primitive_ids.get([&] { return storedPrimitives(impl_->transaction); });
}

std::optional<MapPart> MapReader::partAroundObject(const ContentHash& object, const PartSize& size) const {
  return impl_->partAroundThing(placeOfObject(object), size);
}
std::optional<MapPart> MapReader::partAroundPrimitive(const ContentHash& primitive, const PartSize& size) const {
  return impl_->partAroundThing(placeOfPrimitive(primitive), size);
}

std::optional<MapPart> MapReader::partAroundTile(const perception::TileKey& tile, const PartSize& size) const {
  return impl_->partAroundTile(tile, size);
}
ThingPlace MapReader::placeOfObject(const ContentHash& object) const {
  return mapping::placeOfObject(impl_->transaction, object);
}
ThingPlace MapReader::placeOfPrimitive(const ContentHash& primitive) const {
  return mapping::placeOfPrimitive(impl_->transaction, primitive);
}
std::optional<MapPart> MapReader::partOfLayers(const ThingPlace& thing, const rules::RuleSet& rules, double reach_m,
                                               const LayersAround& around) const {
  TileStages here(impl_->readModel(), impl_->readInputs().params);
  return mapping::partOfLayers(impl_->transaction, here, thing, rules, reach_m, around);
}

std::optional<PrimitivePlace> MapReader::samplePrimitiveOf(const ContentHash& object) const {
  return mapping::samplePrimitiveOf(impl_->transaction, object);
}

bool MapReader::isClassWide(const ContentHash& object) const {
  const std::optional<ObjectRecord> record = storedRecord(impl_->transaction, object);
  return record && record->is_class_wide;
}

PointAnchor MapReader::anchorOf(const ContentHash& object) const {
  TileStages here(impl_->readModel(), impl_->readInputs().params);
  return anchorOfStored(impl_->transaction, here, object);
}

const std::vector<rules::SemanticObject>& MapReader::objects() const {
  return impl_->readObjects();
}
const std::vector<std::string>& MapReader::objectClasses() const {
  return impl_->layers->object_classes.get([&] {
    std::vector<std::string> classes;
    forEachRecord(impl_->transaction,
                  [&](const ContentHash&, const ObjectRecord& record) { classes.push_back(record.class_iri); });
    return classes;
  });
}

std::string MapReader::classOf(std::uint32_t object) const {
  const std::optional<ObjectRecord> record = storedRecord(impl_->transaction, objectIds().at(object));
  return record ? record->class_iri : std::string();
}
const std::vector<OverruledObject>& MapReader::overruled() const {
  return impl_->layers->overruled.get([&] { return storedOverruled(impl_->transaction); });
}

const rules::SemanticObject& MapReader::byRules(const rules::SemanticObject& object) const {
  for (const OverruledObject& changed : overruled())
    if (changed.now == object.id) return changed.by_rules;
  return object;
}

std::vector<rules::SemanticObject> MapReader::objectsByRules() const {
  std::set<ContentHash> stated;
  std::vector<rules::SemanticObject> all;
  for (const OverruledObject& changed : overruled()) {
    if (changed.now) stated.insert(*changed.now);
    all.push_back(changed.by_rules);
  }
  for (const rules::SemanticObject& object : objects())
    if (!stated.contains(object.id)) all.push_back(object);
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return all;
}

std::vector<std::uint64_t> MapReader::decisionTraces() const {
  return storedTraces(impl_->transaction);
}
const rdf::QuadReader& MapReader::quads() const {
  return impl_->quads;
}
const rdf::ReadTransaction& MapReader::transaction() const {
  return impl_->transaction;
}

std::vector<rdf::LayerSize> MapReader::layers() const {
  return rdf::layerSizes(impl_->transaction);
}
MapInputs MapReader::inputs() const {
  return impl_->readInputs();
}

const perception::LabelModel& MapReader::model() const {
  return impl_->readModel();
}

const perception::Scene& MapReader::scene() const {
  return impl_->readScene();
}

const TileStages& MapReader::stages() const {
  return impl_->readStages();
}
const TileStages& MapReader::stagesWithPoints() const {
  return impl_->readStages(true);
}
WayGraph MapReader::ways() const {
  return storedWays(impl_->transaction);
}
WayGraph MapReader::measuredWays() const {
  return mapping::measuredWays(impl_->transaction);
}

PointAnswers MapReader::answersFor(const Cloud& cloud) const {
  const TileStages& stages = impl_->readStages(true);
  const perception::Scene& all = scene();
  const CluxelNumbers& numbers = impl_->readCluxelNumbers();
  const perception::ThinParams& thin = model().perception.thin;
  const scan::ScanPoints points = pointsOf(cloud.id);
  const perception::TileGrid& grid = stages.grid();
  std::map<perception::TileKey, CluxelFinder> finders;
  PointAnswers answers;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p_map = scan::toMap(cloud.T_map_sensor, {points.x[i], points.y[i], points.z[i]});
    const perception::TileKey tile = grid.tileOf(p_map);
    const auto first = numbers.first_of_tile.find(tile);
    if (first == numbers.first_of_tile.end()) refuseDamaged(cloud.source + ": has points in tiles that are not there");
    const CluxelFinder& finder = finders.try_emplace(tile, grid, stages, tile, thin).first->second;
    const std::uint32_t cluxel = first->second + finder.cluxelOf(p_map);
    answers.cluxel.push_back(cluxel);
    answers.label.push_back(static_cast<std::uint8_t>(all.cluxels.label[cluxel]));
    answers.object.push_back(numbers.object[cluxel]);
  }
  return answers;
}

}  // namespace cluxel::mapping
