// SPDX-License-Identifier: Apache-2.0
// Labelling one tile: unary scores, pair costs, message passing, calibration.
#include "perception/crf/labelling.hpp"

#include <cmath>

#include "perception/crf/halo_graph.hpp"
#include "perception/crf/tree_scoring.hpp"
#include "perception/tile_bytes.hpp"

namespace cluxel::perception {

void describe(LabellingParams& params, ParameterVisitor& visitor) {
  visitor.whole({"labelling.sweeps", "1", 1, 100, "sweeps of message passing, each forth and back"}, params.sweeps);
  visitor.real({"labelling.halo", "m", 0, kTileSize_m, "how far around a tile neighbours take part"}, params.halo_m);
}

CalibratedLabel calibrate(const Calibration& calibration, const LabelValues& marginals) {
  LabelValues scores;
  for (std::size_t k = 0; k < scores.size(); ++k)
    scores[k] = calibration.slope * std::log(std::max(marginals[k], 1e-9F)) + calibration.offset[k];
  CalibratedLabel result{0, softmax(scores)};
  float best = -1;
  for (std::size_t k = 0; k < scores.size(); ++k) {
    const float favoured = result.probability[k] * calibration.favour[k];
    if (favoured <= best) continue;
    best = favoured;
    result.label = static_cast<std::uint8_t>(k);
  }
  return result;
}

TileLabeller::TileLabeller(const LabelModel& model)
    : model_(model), trees_(std::make_unique<TreeScorer>(model.unary)) {}

TileLabeller::~TileLabeller() = default;

LabelTile TileLabeller::label(const Ring<FeatureTile>& ring, const LabellingParams& params) const {
  const LabelModel& model = model_;
  const HaloGraph structure = haloGraph(ring, model.pairs.pair_scale == 0 ? 0.0 : params.halo_m);
  const auto scores = trees_->score(nodeFeatures(ring, structure, model.layout.columns.size()));
  const CrfGraph graph = crfGraph(ring, structure, scores, model.pairs);
  const InferenceResult inferred = inferTrws(graph, {.sweeps = static_cast<unsigned>(params.sweeps), .decode = false});
  LabelTile tile;
  tile.key = ring[kRingCentre]->key;
  tile.label.reserve(ring[kRingCentre]->size());
  tile.probability.reserve(ring[kRingCentre]->size());
  for (std::uint32_t i = structure.own_begin; i < structure.own_end; ++i) {
    const CalibratedLabel result = calibrate(model.calibration, inferred.marginals[i]);
    tile.label.push_back(result.label);
    tile.probability.push_back(result.probability);
  }
  return tile;
}

std::string toBytes(const LabelTile& tile) {
  TileWriter writer("LABL", 2, tile.key);
  writer.put(tile.label);
  writer.put(tile.probability);
  return writer.take();
}

LabelTile labelTileFromBytes(std::string_view bytes) {
  TileReader reader(bytes, "LABL", 2);
  LabelTile tile;
  tile.key = reader.key();
  tile.label = reader.getMany<std::uint8_t>();
  tile.probability = reader.getMany<LabelValues>(tile.label.size());
  for (const std::uint8_t label : tile.label)
    reader.require(label < scan::kPrimitiveLabelCount, "has an unknown label");
  for (const LabelValues& values : tile.probability)
    reader.require(allWithin(std::span(values), 1.0 + 1e-5), "has a probability above 1");
  reader.finish();
  return tile;
}

}  // namespace cluxel::perception
