// SPDX-License-Identifier: Apache-2.0
// What the readers of one commit have read of its layers: each layer is read once and shared by all of them.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "mapping/build/tile_stages.hpp"
#include "mapping/map_inputs.hpp"
#include "mapping/statements/overruled_objects.hpp"
#include "perception/segments/scene.hpp"
#include "rdf/ontology/class_names.hpp"
#include "rdf/store/quad_store.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

/// A value that the first who asks reads, while others who ask for it wait. It does not change afterwards. When
/// reading throws, the next who asks reads again. Thread-safe.
template <typename Value>
class ReadOnce {
 public:
  template <typename Read>
  const Value& get(const Read& read) {
    if (const Value* there = there_.load(std::memory_order_acquire)) return *there;
    const std::lock_guard lock(mutex_);
    if (!value_) there_.store(&value_.emplace(read()), std::memory_order_release);
    return *value_;
  }

 private:
  std::atomic<const Value*> there_ = nullptr;  ///< for callers that ask for each point: they take no lock
  std::mutex mutex_;
  std::optional<Value> value_;
};

/// The stored outputs of the stages, and how many readers have them in hand.
struct SharedStages {
  SharedStages(const perception::LabelModel& model, const MapParams& params) : stages(model, params) {}

  TileStages stages;
  bool has_points = false;
  std::atomic<int> holders = 0;
};

/// The stages of one reader. Those that it got before stay where they are.
class HeldStages {
 public:
  HeldStages() = default;
  HeldStages(const HeldStages&) = delete;
  HeldStages& operator=(const HeldStages&) = delete;
  ~HeldStages();

  const std::shared_ptr<SharedStages>& newest() const { return newest_; }
  void hold(const std::shared_ptr<SharedStages>& stages);

 private:
  std::shared_ptr<SharedStages> newest_, before_;
};

/// Where the cluxels of each tile begin in the scene, and the object of each cluxel.
struct CluxelNumbers {
  std::map<perception::TileKey, std::uint32_t> first_of_tile;
  std::vector<std::uint32_t> object;
};

/// Thread-safe. Each reader passes a transaction of its own; all must see the same commit.
class CommitLayers {
 public:
  /// Those of the commit that `quads` sees, as long as some reader has them, or new ones.
  static std::shared_ptr<CommitLayers> of(const rdf::QuadReader& quads);

  /// Sets `mine` to the stages. They hold points and cluxels when `with_points`, else perhaps. `model` and `params`
  /// must be those of this object.
  const TileStages& readStages(const rdf::ReadTransaction& transaction, const perception::LabelModel& model,
                               const MapParams& params, bool with_points, HeldStages& mine);

  ReadOnce<MapInputs> inputs;
  ReadOnce<perception::LabelModel> model;
  ReadOnce<rdf::ClassNames> class_names;
  ReadOnce<std::vector<rules::SemanticObject>> objects;
  ReadOnce<std::vector<ContentHash>> object_ids, primitive_ids;
  ReadOnce<std::vector<std::string>> object_classes;
  ReadOnce<std::vector<OverruledObject>> overruled;
  ReadOnce<CluxelNumbers> cluxel_numbers;
  ReadOnce<perception::Scene> scene;

 private:
  std::mutex stages_mutex_;
  std::shared_ptr<SharedStages> stages_;
};

}  // namespace cluxel::mapping
