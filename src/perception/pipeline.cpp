// SPDX-License-Identifier: Apache-2.0
// The order of the stages, and how far a change of each output reaches.
#include "perception/pipeline.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <string>
#include <utility>

#include "base/parallel.hpp"
#include "perception/stage_inputs.hpp"
#include "perception/stage_tiles.hpp"

namespace cluxel::perception {
namespace {

/// One run over the tiles. A stage computes the tiles of which an input changed, and hands on those whose output did.
class Run {
 public:
  Run(const PerceptionParams& params, TileOutputs& outputs, const RunOptions& options, Axis axis)
      : params_(params), out_(outputs), options_(options), front_(axis) {}

  void toFeatures(TileSegments segments) {
    toGround({std::move(segments)});
    update(
        Stage::Features, out_.features, [this](const StageTiles& changed) { return nearFeatures(changed); },
        [this](const TileKey& key) { return inputs_.featuresOf(key); });
  }
  void toContacts(PointBand band, const TileLabeller& labeller, const SceneParams& params) {
    widths_ = borderWidths(params_, params.labelling);
    toGround(std::move(band));
    label(labeller, params.labelling);          // features to primitive labels, by the CRF (paper 3.1)
    summarise();                                // what the scene reads of points and cluxels
    if (options_.store != nullptr) findEven();  // what ways read of points and ground
    joinComponents(params.component);           // intersecting cluxels of one label to components
    findContacts(params);                       // components that are near each other
    if (!front_.isAtEnd()) dropBefore(front_.firstRead());
  }
  bool isDone() const { return front_.isAtEnd(); }
  const TileSet& changed() const { return all_changed_; }

 private:
  void toGround(PointBand band) {
    front_.moveTo(band.end);
    thin(std::move(band.segments));  // bounds the points where scans pile up
    cluster();                       // points to cluxels (paper 3.1)
    findGround();                    // lowest layers of cell stacks to a surface
  }

  void thin(TileSegments segments) {
    TileSet grown;
    for (const auto& [key, parts] : segments) {
      if (parts.empty()) tiles_.emptied.insert(key);
      if (!options_.anew.contains(key)) grown.insert(key);
    }
    inputs_.readOwn(grown);  // before the points change on which other outputs rest
    const TileSet anew = front_.due(Stage::Points, options_.anew);
    forget(anew);
    TileSet of_both;
    if (options_.donor != nullptr) {
      const TileSet own = options_.store->tiles();
      of_both = commonOf(own, options_.donor->tiles());
      tiles_.lent = without(options_.donor->tiles(), own);
      differing_.fill(without(own, options_.donor->tiles()));
    }
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
    tiles_.all = options_.store != nullptr ? options_.store->tiles() : keysOf(out_.points);
    if (options_.compute_anew)
      for (const TileKey& key : here(anew)) changed_.note(Stage::Points, key, kOtherEverywhere);
    tiles_.forgotten = commonOf(changed_.of(Stage::Points), options_.anew);
    differing_.fill(without(of_both, tiles_.forgotten));  // not computed, so not compared either
    // Most of what is needed, in one pass over scans.
    const TileSet changed = front_.due(Stage::Points, without(changed_.of(Stage::Points), tiles_.lent));
    inputs_.read(front_.due(Stage::Points, around(around(changed))));
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
        Stage::Cluxels, out_.cluxels,
        [this](const StageTiles& changed) { return here(changed.readersOf(Stage::Points)); },
        [this](const TileKey& key) { return clusterTile(ringIn(out_.points, key), params_.clustering); });
  }

  void findGround() {
    update(
        Stage::Ground, out_.ground,
        [this](const StageTiles& changed) { return around(changed.readByAll(Stage::Cluxels)); },
        [this](const TileKey& key) { return groundOf(ringIn(out_.cluxels, key), params_.ground); });
  }

  TileSet nearFeatures(const StageTiles& changed) const {
    return here(unionOf(changed.readersOf(Stage::Cluxels), changed.readersOf(Stage::Ground)));
  }

  /// Features and labels, in waves of rows: rows of features take more memory than all else, and only the labels of
  /// the tile and of its ring read them.
  void label(const TileLabeller& labeller, const LabellingParams& params) {
    const TileSet lent = without(tiles_.lent, nearFeatures(differing_));
    const std::vector<TileKey> features = completed(Stage::Features, without(nearFeatures(changed_), lent));
    near_labels_ = unionOf(std::move(near_labels_), around(unionOf({features.begin(), features.end()}, lent)));
    const std::vector<TileKey> candidates = completed(Stage::Labels, near_labels_);
    inputs_.read(around({features.begin(), features.end()}));  // most of what is needed, at once
    eraseEmptied(Stage::Features, out_.features), eraseEmptied(Stage::Labels, out_.labels);
    take(Stage::Features, lent);
    std::size_t done = 0, seen = 0;
    while (done < features.size() || seen < candidates.size()) {
      const std::size_t first = done;
      while (done < features.size() &&
             (done < first + kAhead || front_.rowOf(features[done]) == front_.rowOf(features[done - 1])))
        ++done;
      compute(Stage::Features, out_.features, features, first, done,
              [this](const TileKey& key) { return inputs_.featuresOf(key); });
      // Tiles before this row have all features that their labels read.
      const std::int64_t row = done < features.size() ? front_.rowOf(features[done]) - 1 : front_.endOf(Stage::Labels);
      std::vector<TileKey> dirty;
      TileSet taken;
      for (; seen < candidates.size() && front_.rowOf(candidates[seen]) < row; ++seen) {
        const TileKey& key = candidates[seen];
        if (tiles_.lent.contains(key) && !differing_.readersOf(Stage::Features).contains(key))
          taken.insert(key);
        else if (tiles_.forgotten.contains(key) || changed_.readersOf(Stage::Features).contains(key))
          dirty.push_back(key);
      }
      take(Stage::Labels, taken);
      compute(Stage::Labels, out_.labels, dirty, 0, dirty.size(),
              [&](const TileKey& key) { return labeller.label(ringIn(out_.features, key), params); });
      if (options_.store != nullptr) inputs_.dropRowsBefore(row - 1, front_.axis());
    }
    if (options_.store != nullptr) inputs_.dropVolumesBefore(front_.firstRead(), front_.axis());
  }

  void summarise() {
    update(
        Stage::Summaries, out_.summaries,
        [](const StageTiles& changed) { return unionOf(changed.of(Stage::Points), changed.of(Stage::Cluxels)); },
        [this](const TileKey& key) { return summaryOf(out_.points.at(key), out_.cluxels.at(key)); });
  }

  void findEven() {
    update(
        Stage::Even, out_.even,
        [this](const StageTiles& changed) {
          return here(unionOf(unionOf(changed.readersOf(Stage::Points), changed.of(Stage::Ground)),
                              changed.readersOf(Stage::Ground)));
        },
        [this](const TileKey& key) { return evenGroundOf(ringIn(out_.points, key), ringIn(out_.ground, key)); });
  }

  void joinComponents(const ComponentParams& params) {
    const auto near = [this](const StageTiles& changed) {
      const TileSet own = unionOf(unionOf(changed.of(Stage::Points), changed.of(Stage::Cluxels)),
                                  unionOf(changed.of(Stage::Features), changed.of(Stage::Labels)));
      return unionOf(own, here(changed.readersOf(Stage::Ground)));
    };
    update(Stage::Components, out_.components, near, [&](const TileKey& key) {
      return componentsOf(out_.points.at(key), out_.cluxels.at(key), out_.features.at(key), out_.labels.at(key),
                          ringIn(out_.ground, key), params);
    });
  }

  void findContacts(const SceneParams& params) {
    const auto near = [this](const StageTiles& changed) {
      return unionOf(changed.of(Stage::Features),
                     here(unionOf(changed.readersOf(Stage::Components), changed.readersOf(Stage::Cluxels))));
    };
    update(Stage::Contacts, out_.contacts, near, [&](const TileKey& key) {
      return contactsOf(ringIn(out_.components, key), ringIn(out_.cluxels, key), out_.features.at(key),
                        params.component, params.contact);
    });
  }

  TileSet around(const TileSet& changed) const { return tiles_.around(changed); }
  /// Gives up outputs that no later stage reads.
  void dropBefore(std::int64_t row) {
    const auto drop = [&](auto& tiles) {
      std::erase_if(tiles, [&](const auto& entry) { return front_.rowOf(entry.first) < row; });
    };
    drop(out_.points), drop(out_.cluxels), drop(out_.ground), drop(out_.features), drop(out_.labels);
    drop(out_.summaries), drop(out_.even), drop(out_.components), drop(out_.contacts);
  }

  /// Those with points.
  TileSet here(const TileSet& tiles) const { return commonOf(tiles, tiles_.all); }

  /// Of the tiles that a stage computes when its inputs changed in `dirty` those that are due, in the order of rows.
  std::vector<TileKey> completed(Stage stage, const TileSet& dirty) const {
    return front_.inRows(front_.due(stage, without(unionOf(dirty, tiles_.forgotten), tiles_.emptied)));
  }

  /// Brings one stage up to date. `near`: the tiles that read an output that is among the changed ones.
  template <typename Tile, typename Near, typename Compute>
  void update(Stage stage, std::map<TileKey, Tile>& tiles, const Near& near, const Compute& compute_tile) {
    const TileSet lent = without(tiles_.lent, near(differing_));
    const std::vector<TileKey> keys = completed(stage, without(near(changed_), lent));
    eraseEmptied(stage, tiles);
    take(stage, lent);
    compute(stage, tiles, keys, 0, keys.size(), compute_tile);
  }

  /// Takes outputs of the donor.
  void take(Stage stage, const TileSet& keys) {
    for (const TileKey& key : keys)
      note(stage, key, options_.store->store(stage, key, options_.donor->bytes(stage, key)));
  }

  void note(Stage stage, const TileKey& key, const OutputChange& change) {
    changed_.note(stage, key, change);
    if (change.is_other) all_changed_.insert(key);
  }

  /// A tile that the donor has, too, may have another output there.
  void compareWithDonor(Stage stage, const TileKey& key, std::string_view stored) {
    if (options_.donor != nullptr && options_.donor->tiles().contains(key))
      differing_.note(stage, key, changeOf(stage, options_.donor->bytes(stage, key), stored));
  }

  /// Computes the keys from `first` to `last` of those that the stage has to compute.
  template <typename Tile, typename Compute>
  void compute(Stage stage, std::map<TileKey, Tile>& tiles, std::span<const TileKey> keys, std::size_t first,
               std::size_t last, const Compute& compute_tile) {
    const double start_s = processorSeconds();
    const auto wanted = keys.subspan(first, last - first);
    inputs_.readFor(tiles, {wanted.begin(), wanted.end()});
    computeEach(stage, tiles, wanted, compute_tile, [&](std::size_t done) {
      if (options_.observer != nullptr) options_.observer->progress(stage, first + done, keys.size());
    });
    if (options_.observer != nullptr) options_.observer->finished(stage, processorSeconds() - start_s);
  }

  template <typename Tile>
  void eraseEmptied(Stage stage, std::map<TileKey, Tile>& tiles) {
    for (const TileKey& key : front_.due(stage, tiles_.emptied)) {
      tiles.erase(key);
      note(stage, key, kOtherEverywhere);
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
      note(stage, keys[i],
           options_.store == nullptr ? kOtherEverywhere : options_.store->store(stage, keys[i], stored));
      compareWithDonor(stage, keys[i], stored);
      done(i + 1);
    };
    const auto work = [&](std::size_t i) {
      outputs[i % kAhead] = compute(keys[i]);
      if (options_.store != nullptr) bytes[i % kAhead] = blockOf(outputs[i % kAhead]);
    };
    parallelInOrder(keys.size(), options_.threads, kAhead, work, take);
  }

  template <typename Tile>
  std::string blockOf(const Tile& tile) const {
    if constexpr (std::is_same_v<Tile, GroundTile>)
      return withBorders(bordersOf(tile, out_.cluxels.at(tile.key), widths_), toBytes(tile));
    else if constexpr (requires { bordersOf(tile, widths_); })
      return withBorders(bordersOf(tile, widths_), toBytes(tile));
    else
      return toBytes(tile);
  }

  static constexpr std::size_t kAhead = 32;  ///< tiles whose outputs may wait for the store

  const PerceptionParams& params_;
  TileOutputs& out_;
  const RunOptions& options_;
  StageFront front_;
  BorderWidths widths_;
  RunTiles tiles_;
  StageInputs inputs_{params_, widths_, out_, options_, tiles_};
  TileSet all_changed_, near_labels_;
  StageTiles changed_, differing_;  ///< against the store, and against the donor
};

}  // namespace

TileSet runStages(PointBands& bands, const TileLabeller& labeller, const SceneParams& params, TileOutputs& outputs,
                  const RunOptions& options) {
  assert(options.store != nullptr && options.donor == nullptr);
  Run run(labeller.model().perception, outputs, options, bands.axis());
  do run.toContacts(bands.next(), labeller, params);
  while (!run.isDone());
  return run.changed();
}

TileSet runStages(TileSegments segments, const TileLabeller& labeller, const SceneParams& params, TileOutputs& outputs,
                  const RunOptions& options) {
  Run run(labeller.model().perception, outputs, options, longerAxis(keysOf(segments)));
  run.toContacts({std::move(segments)}, labeller, params);
  return run.changed();
}

TileOutputs perceive(std::span<const scan::Scan> scans, const PerceptionParams& params, unsigned threads,
                     const TileGrid& grid) {
  checkRanges(params);
  TileOutputs outputs;
  outputs.grid = grid;
  const RunOptions options{.threads = threads};
  Run(params, outputs, options, Axis::X).toFeatures(segmentsOf(scans, grid));
  return outputs;
}

Scene sceneOf(std::span<const scan::Scan> scans, const LabelModel& model, const SceneParams& params, unsigned threads,
              const TileGrid& grid) {
  checkRanges(model.perception);
  TileOutputs outputs;
  outputs.grid = grid;
  runStages(segmentsOf(scans, grid), TileLabeller(model), params, outputs, {.threads = threads});
  return assembleScene(outputs, params.relation);
}

}  // namespace cluxel::perception
