// SPDX-License-Identifier: Apache-2.0
// A map file opened for reading: its layers from cloud to object, its quads, its inputs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cluxel/knowledge/quad_store.hpp"
#include "cluxel/mapping/cloud.hpp"
#include "cluxel/mapping/map_inputs.hpp"
#include "cluxel/perception/scene.hpp"
#include "cluxel/reasoning/semantic_object.hpp"

namespace cluxel {

class TileStages;

struct MapSummary {
  bool is_finished = false;
  std::string inputs_hash;
  std::size_t clouds = 0, objects = 0;
  std::uint64_t points = 0, quads = 0;
  std::map<std::string, std::size_t> objects_by_class;  ///< by local name of the class
};

/// Which cluxel each point of a cloud belongs to, and what became of it. Arrays follow the cloud's points.
struct PointAnswers {
  std::vector<std::uint32_t> cluxel;  ///< number in the scene's cluxels
  std::vector<std::uint8_t> label;    ///< PrimitiveLabel
  std::vector<std::uint32_t> object;  ///< number in objects(), or kNoObjectOfPoint
};
inline constexpr std::uint32_t kNoObjectOfPoint = 0xffffffffU;

/// One consistent state of a map. Not thread-safe.
class MapReader {
 public:
  /// Throws Error (StoreUnavailable) when the file is not a map that can be read.
  explicit MapReader(const std::filesystem::path& file);
  ~MapReader();
  MapReader(MapReader&&) noexcept;

  MapSummary summary() const;
  std::vector<Cloud> clouds() const;
  ScanPoints pointsOf(const ScanId& cloud) const;
  /// The objects, sorted by id; cluxel numbers refer to scene().
  const std::vector<SemanticObject>& objects() const;
  /// The scene, assembled from the stored tiles at the first call.
  const Scene& scene() const;
  /// The stored outputs of the stages, read at the first call.
  const TileStages& stages() const;
  PointAnswers answersFor(const Cloud& cloud) const;
  const QuadReader& quads() const;
  MapInputs inputs() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// "Tree" of "https://w3id.org/cluxel/ontology#Tree".
std::string localName(std::string_view iri);

}  // namespace cluxel
