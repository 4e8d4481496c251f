// SPDX-License-Identifier: Apache-2.0
// The order of the stages, and how far a change of each output reaches.
#include "perception/pipeline.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include "base/parallel.hpp"
#include "perception/stage_tiles.hpp"

namespace cluxel::perception {
namespace {

/// One run over the tiles. A stage computes the tiles of which an input changed, and hands on those whose output did.
class Run {
 public:
  Run(const PerceptionParams& params, TileOutputs& outputs, const RunOptions& options)
      : params_(params), out_(outputs), options_(options) {}

  void toFeatures(TileSegments segments) {
    toGround(std::move(segments));
    update(
        Stage::Features, out_.features, [this](const StageTiles& changed) { return nearFeatures(changed); },
        [this](const TileKey& key) { return featuresOf(key); });
  }
  void toContacts(TileSegments segments, const TileLabeller& labeller, const SceneParams& params) {
    toGround(std::move(segments));
    label(labeller, params.labelling);          // features to primitive labels, by the CRF (paper 3.1)
    summarise();                                // what the scene reads of points and cluxels
    if (options_.store != nullptr) findEven();  // what ways read of points and ground
    joinComponents(params.component);           // intersecting cluxels of one label to components
    findContacts(params);                       // components that are near each other
  }
  const TileSet& changed() const { return all_changed_; }

 private:
  void toGround(TileSegments segments) {
    thin(std::move(segments));  // bounds the points where scans pile up
    cluster();                  // points to cluxels (paper 3.1)
    findGround();               // lowest layers of cell stacks to a surface
  }

  void thin(TileSegments segments) {
    TileSet grown;
    for (const auto& [key, parts] : segments) {
      if (parts.empty()) emptied_.insert(key);
      if (!options_.anew.contains(key)) grown.insert(key);
    }
    loadFor(grown);  // before the points change on which other outputs rest
    forget(options_.anew);
    const TileSet own = options_.donor != nullptr ? options_.store->tiles() : TileSet();
    if (options_.donor != nullptr) lent_ = without(options_.donor->tiles(), own);
    differing_.fill(own);
    const TileSet with_segments = keysOf(segments), present = keysOf(out_.points);
    update(
        Stage::Points, out_.points, [&](const StageTiles&) { return with_segments; },
        [&](const TileKey& key) {
          std::vector<const ScanSegment*> parts;
          for (const ScanSegment& segment : segments.at(key)) parts.push_back(&segment);
          TilePoints fresh = perception::thin(key, parts, params_.thin);
          if (!grown.contains(key) || !present.contains(key)) return fresh;
          return perception::thin(key, std::array<const TilePoints*, 2>{&out_.points.at(key), &fresh}, params_.thin);
        });
    tiles_ = options_.store != nullptr ? options_.store->tiles() : keysOf(out_.points);
    TileSet& changed = changed_[Stage::Points];
    if (options_.compute_all) changed = unionOf(std::move(changed), tiles_);
    std::set_intersection(changed.begin(), changed.end(), options_.anew.begin(), options_.anew.end(),
                          std::inserter(forgotten_, forgotten_.end()));
    loadAround(without(changed, lent_), own);
  }

  /// Stored outputs of these tiles rest on points that are not there any more: stages do not read them.
  void forget(const TileSet& keys) {
    for (const TileKey& key : keys) {
      out_.points.erase(key), out_.cluxels.erase(key), out_.ground.erase(key), out_.features.erase(key);
      out_.labels.erase(key), out_.summaries.erase(key), out_.even.erase(key);
      out_.components.erase(key), out_.contacts.erase(key);
    }
  }

  void cluster() {
    update(
        Stage::Cluxels, out_.cluxels, [this](const StageTiles& changed) { return around(changed[Stage::Points]); },
        [this](const TileKey& key) { return clusterTile(ringIn(out_.points, key), params_.clustering); });
  }

  void findGround() {
    update(
        Stage::Ground, out_.ground, [this](const StageTiles& changed) { return around(changed[Stage::Cluxels]); },
        [this](const TileKey& key) { return groundOf(ringIn(out_.cluxels, key), params_.ground); });
  }

  TileSet nearFeatures(const StageTiles& changed) const {
    return around(unionOf(changed[Stage::Cluxels], changed[Stage::Ground]));
  }

  /// Cluxels and their 2-ring to HOR and other features (paper 3.1).
  FeatureTile featuresOf(const TileKey& key) const {
    return computeFeatures(ringIn(out_.cluxels, key), ringIn(out_.ground, key), params_.features);
  }

  /// Features and labels, in waves along x: rows of features take more memory than all else, and only the labels of
  /// the tile and of its ring read them.
  void label(const TileLabeller& labeller, const LabellingParams& params) {
    const TileSet lent = without(lent_, nearFeatures(differing_));
    const std::vector<TileKey> features = completed(without(nearFeatures(changed_), lent));
    const std::vector<TileKey> candidates = completed(around(unionOf({features.begin(), features.end()}, lent)));
    eraseEmptied(Stage::Features, out_.features), eraseEmptied(Stage::Labels, out_.labels);
    take(Stage::Features, lent);
    std::size_t done = 0, seen = 0;
    while (done < features.size() || seen < candidates.size()) {
      const std::size_t first = done;
      while (done < features.size() && (done < first + kAhead || features[done].x == features[done - 1].x)) ++done;
      compute(Stage::Features, out_.features, features, first, done,
              [this](const TileKey& key) { return featuresOf(key); });
      // Tiles up to this column have their features.
      const std::int32_t column =
          done < features.size() ? features[done].x - 1 : std::numeric_limits<std::int32_t>::max();
      std::vector<TileKey> dirty;
      TileSet taken;
      for (; seen < candidates.size() && candidates[seen].x < column; ++seen) {
        const TileKey& key = candidates[seen];
        if (lent_.contains(key) && !readsFeatures(key, differing_))
          taken.insert(key);
        else if (options_.compute_all || forgotten_.contains(key) || readsFeatures(key, changed_))
          dirty.push_back(key);
      }
      take(Stage::Labels, taken);
      compute(Stage::Labels, out_.labels, dirty, 0, dirty.size(),
              [&](const TileKey& key) { return labeller.label(ringIn(out_.features, key), params); });
      if (options_.store != nullptr) dropRowsBefore(column - 1);
    }
    if (options_.store != nullptr) dropVolumesOfAll();
  }

  void summarise() {
    update(
        Stage::Summaries, out_.summaries,
        [](const StageTiles& changed) { return unionOf(changed[Stage::Points], changed[Stage::Cluxels]); },
        [this](const TileKey& key) { return summaryOf(out_.points.at(key), out_.cluxels.at(key)); });
  }

  void findEven() {
    update(
        Stage::Even, out_.even,
        [this](const StageTiles& changed) { return around(unionOf(changed[Stage::Points], changed[Stage::Ground])); },
        [this](const TileKey& key) { return evenGroundOf(ringIn(out_.points, key), ringIn(out_.ground, key)); });
  }

  void joinComponents(const ComponentParams& params) {
    const auto near = [this](const StageTiles& changed) {
      const TileSet own = unionOf(unionOf(changed[Stage::Points], changed[Stage::Cluxels]),
                                  unionOf(changed[Stage::Features], changed[Stage::Labels]));
      return unionOf(own, around(changed[Stage::Ground]));
    };
    update(Stage::Components, out_.components, near, [&](const TileKey& key) {
      return componentsOf(out_.points.at(key), out_.cluxels.at(key), out_.features.at(key), out_.labels.at(key),
                          ringIn(out_.ground, key), params);
    });
  }

  void findContacts(const SceneParams& params) {
    const auto near = [this](const StageTiles& changed) {
      return unionOf(changed[Stage::Features], around(unionOf(changed[Stage::Components], changed[Stage::Cluxels])));
    };
    update(Stage::Contacts, out_.contacts, near, [&](const TileKey& key) {
      return contactsOf(ringIn(out_.components, key), ringIn(out_.cluxels, key), out_.features.at(key),
                        params.component, params.contact);
    });
  }

  TileSet around(const TileSet& changed) const { return withRing(changed, tiles_); }

  /// Reads what the stages after the points may read: a change of points reaches labels up to four tiles away, and
  /// contacts five. Labels read rows of the fifth, which are computed from volumes of the sixth, and these from points
  /// of the seventh.
  /// Of the donor's tiles only those are computed that are near others.
  void loadAround(const TileSet& changed, const TileSet& own) {
    const TileSet near_own = aroundFar(own), near_lent = aroundFar(lent_);
    TileSet tiles = aroundFar(changed);
    std::set_intersection(near_own.begin(), near_own.end(), near_lent.begin(), near_lent.end(),
                          std::inserter(tiles, tiles.end()));
    loadFor(without(without(tiles, forgotten_), lent_));
    if (options_.donor == nullptr) return;
    std::erase_if(tiles, [this](const TileKey& key) { return !lent_.contains(key); });
    options_.donor->load(tiles, out_);
  }

  TileSet aroundFar(TileSet tiles) const {
    for (int ring = 0; ring < 7 && !tiles.empty(); ++ring) tiles = around(tiles);
    return tiles;
  }

  void loadFor(const TileSet& tiles) {
    if (options_.store != nullptr && !options_.compute_all) options_.store->load(tiles, out_);
  }

  /// What is not stored is computed again before a stage reads it.
  template <typename Tile>
  void prepare(const std::map<TileKey, Tile>& /*stage*/, const TileSet& /*keys*/) {}
  void prepare(const std::map<TileKey, FeatureTile>& /*stage*/, const TileSet& keys) { addVolumesOf(around(keys)); }
  void prepare(const std::map<TileKey, LabelTile>& /*stage*/, const TileSet& keys) { addRowsOf(around(keys)); }

  void addVolumesOf(const TileSet& keys) {
    std::vector<CluxelTile*> without;
    for (const TileKey& key : keys)
      if (CluxelTile& tile = out_.cluxels.at(key); !tile.hasVolumes()) without.push_back(&tile);
    parallelFor(without.size(), options_.threads, [&](std::size_t i) {
      addVolumes(ringIn(out_.points, without[i]->key), params_.clustering, *without[i]);
    });
  }

  void addRowsOf(const TileSet& keys) {
    TileSet without;
    for (const TileKey& key : keys)
      if (!out_.features.at(key).hasRows()) without.insert(key);
    addVolumesOf(around(without));
    const std::vector<TileKey> each(without.begin(), without.end());
    parallelFor(each.size(), options_.threads, [&](std::size_t i) { out_.features.at(each[i]) = featuresOf(each[i]); });
  }

  /// They are not stored; later runs compute them again where they need them.
  void dropRowsBefore(std::int32_t column) {
    for (auto& [key, tile] : out_.features)
      if (key.x < column) tile.dropRows();
  }
  void dropVolumesOfAll() {
    for (auto& [key, tile] : out_.cluxels) dropVolumes(tile);
  }

  /// The tiles that a stage computes when its inputs changed in `dirty`, ascending.
  std::vector<TileKey> completed(TileSet dirty) const {
    const TileSet& points = changed_[Stage::Points];
    if (options_.compute_all) dirty.insert(points.begin(), points.end());
    dirty.insert(forgotten_.begin(), forgotten_.end());
    std::vector<TileKey> keys;
    std::set_difference(dirty.begin(), dirty.end(), emptied_.begin(), emptied_.end(), std::back_inserter(keys));
    return keys;
  }

  /// Brings one stage up to date. `near`: the tiles that read an output that is among the changed ones.
  template <typename Tile, typename Near, typename Compute>
  void update(Stage stage, std::map<TileKey, Tile>& tiles, const Near& near, const Compute& compute_tile) {
    const TileSet lent = without(lent_, near(differing_));
    const std::vector<TileKey> keys = completed(without(near(changed_), lent));
    eraseEmptied(stage, tiles);
    take(stage, lent);
    compute(stage, tiles, keys, 0, keys.size(), compute_tile);
  }

  /// Takes outputs of the donor.
  void take(Stage stage, const TileSet& keys) {
    for (const TileKey& key : keys)
      if (options_.store->store(stage, key, options_.donor->bytes(stage, key))) note(stage, key);
  }

  void note(Stage stage, const TileKey& changed) {
    changed_[stage].insert(changed);
    all_changed_.insert(changed);
  }

  /// Computes the keys from `first` to `last` of those that the stage has to compute.
  template <typename Tile, typename Compute>
  void compute(Stage stage, std::map<TileKey, Tile>& tiles, std::span<const TileKey> keys, std::size_t first,
               std::size_t last, const Compute& compute_tile) {
    const double start_s = processorSeconds();
    const auto wanted = keys.subspan(first, last - first);
    prepare(tiles, {wanted.begin(), wanted.end()});
    computeEach(stage, tiles, wanted, compute_tile, [&](std::size_t done) {
      if (options_.observer != nullptr) options_.observer->progress(stage, first + done, keys.size());
    });
    if (options_.observer != nullptr) options_.observer->finished(stage, processorSeconds() - start_s);
  }

  template <typename Tile>
  void eraseEmptied(Stage stage, std::map<TileKey, Tile>& tiles) {
    for (const TileKey& key : emptied_) {
      tiles.erase(key);
      note(stage, key);
      if (options_.store != nullptr) options_.store->erase(stage, key);
    }
  }

  /// Outputs are stored while later ones are computed. Stages read no output of their own but that of the same tile.
  template <typename Tile, typename Compute, typename Done>
  void computeEach(Stage stage, std::map<TileKey, Tile>& tiles, std::span<const TileKey> keys, const Compute& compute,
                   const Done& done) {
    for (const TileKey& key : keys) tiles.try_emplace(key);  // a map with all keys may be searched while tiles change
    std::vector<Tile> outputs(std::min(kAhead, keys.size()));
    std::vector<std::string> bytes(outputs.size());
    const auto take = [&](std::size_t i) {
      const std::string stored = std::move(bytes[i % kAhead]);  // and gives the memory back
      tiles.at(keys[i]) = std::move(outputs[i % kAhead]);
      if (options_.store == nullptr || options_.store->store(stage, keys[i], stored)) note(stage, keys[i]);
      if (lent_.contains(keys[i]) && options_.donor->bytes(stage, keys[i]) != stored) differing_[stage].insert(keys[i]);
      done(i + 1);
    };
    const auto work = [&](std::size_t i) {
      outputs[i % kAhead] = compute(keys[i]);
      if (options_.store != nullptr) bytes[i % kAhead] = toBytes(outputs[i % kAhead]);
    };
    parallelInOrder(keys.size(), options_.threads, kAhead, work, take);
  }

  static constexpr std::size_t kAhead = 32;  ///< tiles whose outputs may wait for the store

  const PerceptionParams& params_;
  TileOutputs& out_;
  const RunOptions& options_;
  TileSet tiles_;
  TileSet emptied_;    ///< tiles that lost their points
  TileSet forgotten_;  ///< tiles whose stored outputs are not read; every stage computes them
  TileSet lent_;       ///< tiles that only the donor has
  TileSet all_changed_;
  StageTiles changed_, differing_;  ///< against the store, and against the donor
};

}  // namespace

TileSet runStages(TileSegments segments, const TileLabeller& labeller, const SceneParams& params, TileOutputs& outputs,
                  const RunOptions& options) {
  Run run(labeller.model().perception, outputs, options);
  run.toContacts(std::move(segments), labeller, params);
  return run.changed();
}

TileOutputs perceive(std::span<const scan::Scan> scans, const PerceptionParams& params, unsigned threads) {
  checkRanges(params);
  TileOutputs outputs;
  const RunOptions options{.threads = threads};
  Run(params, outputs, options).toFeatures(segmentsOf(scans));
  return outputs;
}

Scene sceneOf(std::span<const scan::Scan> scans, const LabelModel& model, const SceneParams& params, unsigned threads) {
  checkRanges(model.perception);
  TileOutputs outputs;
  runStages(segmentsOf(scans), TileLabeller(model), params, outputs, {.threads = threads});
  return assembleScene(outputs, params.relation);
}

}  // namespace cluxel::perception
