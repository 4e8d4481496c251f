// SPDX-License-Identifier: Apache-2.0
// Perception's stages over a map's tiles: outputs are kept in the map file, and only what a change reaches is computed.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "cluxel/progress.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/map_inputs.hpp"
#include "perception/pipeline.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Batches of more than one and a half times as many points go through the stages in bands. Memory follows this number.
inline constexpr std::uint64_t kStagePoints = 6'000'000;

/// What TileStages keeps in memory when the scene is assembled.
enum class Keep : std::uint8_t { Summaries, All };

/// What changed in the stored outputs of tiles since it was begun.
struct OutputChanges {
  perception::TileSet tiles;  ///< of which an output changed, also those that are gone
  /// The summaries that these tiles had before, as stored; absent where there were none.
  std::map<perception::TileKey, std::optional<std::string>> former_summaries;
  bool has_copied_map = false;  ///< tiles and rows of objects of another map were copied
  /// The only map that was copied, if it lends what it decided and nothing else changed; else null.
  const rdf::ReadTransaction* lender = nullptr;
};

/// `model` and `params` must outlive it.
class TileStages {
 public:
  /// What has more than 1.5 times `max_points` points goes through the stages in bands, and so does what touches tiles
  /// that hold `max_points` or more. Each band but the last has half of `max_points` points or more.
  TileStages(const perception::LabelModel& model, const MapParams& params, Keep keep = Keep::All,
             std::uint64_t max_points = kStagePoints)
      : params_{params.labelling, params.component, params.contact, params.relation},
        labeller_(model),
        keep_(keep),
        max_points_(max_points) {}

  std::uint64_t maxPoints() const { return max_points_; }

  /// Brings every stage but ways up to date after scans were stored or removed. Returns the tiles of which an output
  /// changed.
  perception::TileSet update(rdf::WriteTransaction& transaction, PointChanges changes, unsigned threads,
                             ProgressSink& sink);
  /// Computes all stages of these tiles, because the model or the settings changed, and what follows from them. Returns
  /// the tiles of which an output changed. All is up to date when it was called for all tiles of the map.
  perception::TileSet computeAnew(rdf::WriteTransaction& transaction, perception::TileSet tiles, unsigned threads,
                                  ProgressSink& sink);
  /// Brings the two stages of ways up to date after update() or computeAnew(). Returns whether what some tile
  /// contributes to ways changed since ways were read last. The scene may be taken meanwhile.
  bool updateWays(rdf::WriteTransaction& transaction, unsigned threads);
  /// The stages of ways count the even ground of `changed` as changed, and that of other tiles in `kept` no longer.
  void noteEven(const perception::TileSet& kept, const perception::TileSet& changed);
  /// The tiles of which an output changed since the last call of this function.
  perception::TileSet takeChangedOutputs() { return std::exchange(changed_outputs_, {}); }
  /// Those of `changed` count as such, and other tiles in `kept` no longer.
  void noteOutputs(const perception::TileSet& kept, const perception::TileSet& changed) {
    for (const perception::TileKey& tile : kept) changed_outputs_.erase(tile);
    changed_outputs_.insert(changed.begin(), changed.end());
  }
  /// Gives outputs of many tiles back; those of few are likely to be read again soon.
  void dropIfMany() {
    constexpr std::size_t kFew = 400;
    if (outputs_.summaries.size() > kFew) dropAll();
  }
  /// The tiles of the changes that takeChanges() would return.
  const perception::TileSet& changedTiles() const { return changes_.tiles; }
  /// All changes since the last call of this function.
  OutputChanges takeChanges() { return std::exchange(changes_, {}); }
  /// Reads what the scene is assembled from, of all tiles. Cost: about 100 ns a cluxel.
  void load(const rdf::ReadTransaction& transaction);
  /// The same for these tiles alone; others are given up. Of the tiles next to them the ground is read, too.
  void hold(const rdf::ReadTransaction& transaction, const perception::TileSet& tiles,
            const perception::TileSet& around);
  /// From now on the outputs of `tiles` are read from `earlier`, a commit that must outlive these reads. Null: none
  /// are.
  void readAsBefore(const rdf::ReadTransaction* earlier, perception::TileSet tiles);
  /// Reads the points of all tiles from the scans, and computes from them what is measured of cluxels. Cost: about
  /// 150 ns a point.
  void loadPoints(const rdf::ReadTransaction& transaction);
  /// The same of some tiles.
  void loadPoints(const rdf::ReadTransaction& transaction, const perception::TileSet& tiles);
  /// Gives the memory of points and cluxels back.
  void dropPoints();
  /// The same of these tiles.
  void dropPoints(const perception::TileSet& tiles) {
    for (const perception::TileKey& tile : tiles) outputs_.points.erase(tile), outputs_.cluxels.erase(tile);
  }
  /// The same for all outputs; they are read again when they are needed.
  void dropAll() {
    outputs_ = {};
    even_.clear();
  }
  /// The scene of what is loaded, seen from the clouds of the map.
  perception::Scene scene(const std::vector<Cloud>& clouds) const {
    return assembleScene(outputs_, params_.relation, viewsOf(clouds));
  }
  /// The scene of the tiles that are held. `elsewhere`: other tiles of the map next to them; `hidden`: those that do
  /// not count.
  perception::SceneWindow window(const perception::TileSet& elsewhere, const perception::TileSet& hidden,
                                 const std::vector<Cloud>& clouds) const {
    return assembleWindow(outputs_, elsewhere, hidden, params_.relation, viewsOf(clouds));
  }
  /// The cluxels of the tiles that are held, without their primitives.
  perception::SceneCluxels heldCluxels(const perception::TileSet& elsewhere) const {
    return assembleCluxels(outputs_, elsewhere);
  }
  /// The scene of what is loaded; gives memory back.
  perception::Scene takeScene(const std::vector<Cloud>& clouds);
  /// The seeds of the scene's cluxels.
  perception::SceneSeeds seeds() const { return seedsOf(outputs_); }

  /// Of the map that was read last.
  const perception::TileGrid& grid() const { return outputs_.grid; }
  /// Of the tiles for which loadPoints() was called.
  const std::map<perception::TileKey, perception::TilePoints>& points() const { return outputs_.points; }
  const std::map<perception::TileKey, perception::CluxelTile>& cluxels() const { return outputs_.cluxels; }
  const std::map<perception::TileKey, perception::SummaryTile>& summaries() const { return outputs_.summaries; }
  const std::map<perception::TileKey, perception::GroundTile>& ground() const { return outputs_.ground; }
  const std::map<perception::TileKey, perception::ComponentTile>& components() const { return outputs_.components; }

 private:
  perception::TileSet run(rdf::WriteTransaction& transaction, PointChanges changes, unsigned threads, bool compute_anew,
                          ProgressSink& sink);

  perception::SceneParams params_;
  perception::TileLabeller labeller_;
  Keep keep_;
  std::uint64_t max_points_;
  perception::TileOutputs outputs_;
  const rdf::ReadTransaction* earlier_ = nullptr;
  perception::TileSet read_as_before_;
  OutputChanges changes_;
  /// Tiles of which the even ground changed, came or went since the stages of ways were brought up to date.
  perception::TileSet changed_even_;
  perception::TileSet changed_outputs_;                       ///< as takeChangedOutputs() returns them
  std::map<perception::TileKey, perception::EvenTile> even_;  ///< of those that are at hand
};

/// Whether two maps store the same output of a stage, or of all stages but ways, for a tile that both have.
bool haveSameOutput(const rdf::ReadTransaction& a, const rdf::ReadTransaction& b, perception::Stage stage,
                    const perception::TileKey& tile);
bool haveSameOutputs(const rdf::ReadTransaction& a, const rdf::ReadTransaction& b, const perception::TileKey& tile);

}  // namespace cluxel::mapping
