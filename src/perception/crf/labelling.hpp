// SPDX-License-Identifier: Apache-2.0
// Fifth stage: labels and probabilities of a tile's cluxels, from the features of the tile and its ring, by the CRF.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "perception/crf/crf_inference.hpp"
#include "perception/crf/label_model.hpp"
#include "perception/features/feature_tile.hpp"
#include "perception/stage_params.hpp"

namespace cluxel::perception {

struct LabellingParams {
  int sweeps = 3;       ///< of message passing, each forward and backward
  double halo_m = 1.0;  ///< cluxels of the ring take part up to this distance from the tile
};
void describe(LabellingParams& params, ParameterVisitor& visitor);

class TreeScorer;

/// A model prepared for labelling. `model` must outlive it. Thread-safe.
class TileLabeller {
 public:
  explicit TileLabeller(const LabelModel& model);
  ~TileLabeller();
  TileLabeller(const TileLabeller&) = delete;
  TileLabeller& operator=(const TileLabeller&) = delete;

  /// Labels the cluxels of the ring's centre tile, which must exist. Features must have been computed with
  /// `model.perception`. Cost: about 1.3 us a cluxel on sparse scans, edges and halo included.
  const LabelModel& model() const { return model_; }

  LabelTile label(const Ring<FeatureTile>& ring, const LabellingParams& params) const;

 private:
  const LabelModel& model_;
  std::unique_ptr<const TreeScorer> trees_;
};

std::string toBytes(const LabelTile& tile);
/// Throws Error (StoreUnavailable) when the bytes are damaged or of another kind.
LabelTile labelTileFromBytes(std::string_view bytes);

/// Probability and label from the marginals of one cluxel.
struct CalibratedLabel {
  std::uint8_t label = 0;
  LabelValues probability{};
};
CalibratedLabel calibrate(const Calibration& calibration, const LabelValues& marginals);

}  // namespace cluxel::perception
