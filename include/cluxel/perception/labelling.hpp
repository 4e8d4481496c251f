// SPDX-License-Identifier: Apache-2.0
// The labelling stage: features of a tile and its ring to labels and probabilities of the tile's cluxels.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/perception/crf_inference.hpp"
#include "cluxel/perception/feature_tile.hpp"
#include "cluxel/perception/label_model.hpp"
#include "cluxel/perception/stage_params.hpp"

namespace cluxel {

struct LabellingParams {
  int sweeps = 3;       ///< of message passing, each forth and back
  double halo_m = 1.0;  ///< the ring's cluxels take part up to this distance from the tile
};
void describe(LabellingParams& params, ParameterVisitor& visitor);

class TreeScorer;

/// A model made ready to label tiles, which it must outlive. May be used by many threads at once.
class TileLabeller {
 public:
  explicit TileLabeller(const LabelModel& model);
  ~TileLabeller();
  TileLabeller(const TileLabeller&) = delete;
  TileLabeller& operator=(const TileLabeller&) = delete;

  /// Labels the cluxels of the ring's centre tile. A pure function of the model and the arguments. The centre must be
  /// there; the tiles must have been made with `model.perception`. Cost: some 1.3 us a cluxel of Oakland, edges and
  /// halo included.
  LabelTile label(const Ring<FeatureTile>& ring, const LabellingParams& params) const;

 private:
  const LabelModel& x_model;
  std::unique_ptr<const TreeScorer> x_trees;
};

std::string toBytes(const LabelTile& tile);
/// Throws Error (StoreUnavailable) when the bytes are not such a tile.
LabelTile labelTileFromBytes(std::string_view bytes);

/// Probability and label from the marginals of one cluxel.
struct CalibratedLabel {
  std::uint8_t label = 0;
  LabelValues probability{};
};
CalibratedLabel calibrate(const Calibration& calibration, const LabelValues& marginals);

}  // namespace cluxel
