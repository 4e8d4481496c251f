// SPDX-License-Identifier: Apache-2.0
// Read access to a map file: layers from cloud to object, quads, inputs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mapping/clouds/cloud.hpp"
#include "mapping/map_inputs.hpp"
#include "mapping/statements/statement.hpp"
#include "perception/segments/scene.hpp"
#include "rdf/file/space/layer_sizes.hpp"
#include "rdf/ontology/class_names.hpp"
#include "rdf/store/quad_store.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::rules {
struct RuleSet;
}

namespace cluxel::mapping {

class TileStages;
struct WayGraph;
struct LayersAround;
struct PartSize;
struct MapPart;
struct ThingPlace;
struct PrimitivePlace;
struct OverruledObject;

struct MapSummary {
  bool is_finished = false;
  std::string inputs_hash;
  std::size_t clouds = 0, objects = 0;
  std::uint64_t points = 0, quads = 0;
  std::map<std::string, std::size_t> objects_by_class;  ///< by the name of the class in classNames()
};

/// The cluxel, label and object of each point of a cloud. The arrays are parallel to the cloud's points.
struct PointAnswers {
  std::vector<std::uint32_t> cluxel;  ///< number in the scene's cluxels
  std::vector<std::uint8_t> label;    ///< PrimitiveLabel
  std::vector<std::uint32_t> object;  ///< number in objects(), or kNoObjectOfPoint
};
inline constexpr std::uint32_t kNoObjectOfPoint = 0xffffffffU;

/// One snapshot of a map. Not thread-safe. What it reads once is shared with the other readers of its commit in this
/// process, which other threads may use, and lasts as long as one of them.
class MapReader {
 public:
  /// Throws Error (StoreUnavailable) when the file is not a readable map.
  explicit MapReader(const std::filesystem::path& file);
  ~MapReader();
  MapReader(MapReader&&) noexcept;

  MapSummary summary() const;
  /// False when the map holds only some scans of a build that was interrupted. Cost: none.
  bool isFinished() const;
  std::vector<Cloud> clouds() const;
  scan::ScanPoints pointsOf(const scan::ScanId& cloud) const;
  /// A cloud as the scan that it was given as.
  scan::Scan scanOf(const scan::ScanId& cloud) const;
  /// The ids of objects(), and of the scene's primitives, ascending. Cost: some microseconds an object, or a tile.
  const std::vector<ContentHash>& objectIds() const;
  const std::vector<ContentHash>& primitiveIds() const;
  /// The part of the map around all primitives of an object, around one, or around a tile, for which `near_m` does not
  /// count. Without the near objects when these are most of the map. Absent as for partOfMap(), and when the part would
  /// be larger than `size` allows.
  std::optional<MapPart> partAroundObject(const ContentHash& object, const PartSize& size) const;
  std::optional<MapPart> partAroundPrimitive(const ContentHash& primitive, const PartSize& size) const;
  std::optional<MapPart> partAroundTile(const perception::TileKey& tile, const PartSize& size) const;
  /// As the functions of mapping/map_part.
  ThingPlace placeOfObject(const ContentHash& object) const;
  ThingPlace placeOfPrimitive(const ContentHash& primitive) const;
  std::optional<MapPart> partOfLayers(const ThingPlace& thing, const rules::RuleSet& rules, double reach_m,
                                      const LayersAround& around) const;
  /// As samplePrimitiveOf() in map_part.hpp.
  std::optional<PrimitivePlace> samplePrimitiveOf(const ContentHash& object) const;
  /// Whether an object takes in all of its class, as the ground does. False when there is none.
  bool isClassWide(const ContentHash& object) const;
  /// The points that a statement about an object is anchored to. Cost: that of the object's tiles.
  PointAnchor anchorOf(const ContentHash& object) const;
  /// The objects, sorted by id; cluxel numbers refer to scene().
  const std::vector<rules::SemanticObject>& objects() const;
  /// The IRIs of the classes of objects(), in their order, without what else is read for these. Cost: a microsecond an
  /// object.
  const std::vector<std::string>& objectClasses() const;
  /// The class of an object by its number in objects(), which need not be read for it.
  std::string classOf(std::uint32_t object) const;
  /// What the classes of the map's ontology and objects are called in lists and counts. Read by the first call.
  const rdf::ClassNames& classNames() const;
  /// Those that operator statements changed or removed, as the rules made them.
  const std::vector<OverruledObject>& overruled() const;
  /// The object as the rules made it: itself where nothing was stated.
  const rules::SemanticObject& byRules(const rules::SemanticObject& object) const;
  /// The objects as the rules made them, sorted by id.
  std::vector<rules::SemanticObject> objectsByRules() const;
  /// Traces of the decisions about each of the scene's primitives; empty for a map that has none.
  std::vector<std::uint64_t> decisionTraces() const;
  /// The scene, assembled from the stored tiles by the first call. Who needs stages(), too, takes these first, or they
  /// are read twice.
  const perception::Scene& scene() const;
  /// The stored outputs of the stages without points and cluxels, read by the first call.
  const TileStages& stages() const;
  /// The same with points and cluxels, which take most of the time and memory.
  const TileStages& stagesWithPoints() const;
  /// Merged by each call. Cost: some 20 microseconds a tile.
  WayGraph ways() const;
  /// With what gone things left in the ground: rules that ask the map see these. Cost: about 1 ms a tile.
  WayGraph measuredWays() const;
  PointAnswers answersFor(const Cloud& cloud) const;
  const rdf::QuadReader& quads() const;
  /// The snapshot that everything here is read from.
  const rdf::ReadTransaction& transaction() const;
  /// The bytes of the file by table. Cost and errors as for rdf::layerSizes().
  std::vector<rdf::LayerSize> layers() const;
  MapInputs inputs() const;
  /// Parsed by the first call.
  const perception::LabelModel& model() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// "Tree" of "https://w3id.org/cluxel/ontology#Tree".
std::string localName(std::string_view iri);

}  // namespace cluxel::mapping
