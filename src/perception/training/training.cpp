// SPDX-License-Identifier: Apache-2.0
// Training: unaries that leave one group out, pairwise term and calibration fitted to their scores, then the final
// unary on all groups.
#include "perception/training/training.hpp"

#include <algorithm>

#include "base/content_hash.hpp"
#include "cluxel/error.hpp"
#include "perception/training/training_folds.hpp"

namespace cluxel::perception {

namespace {

/// Everything of a report except the final unary, from groups left out.
class PairSearch {
 public:
  PairSearch(const std::vector<ScoredTile>& tiles, const FeatureLayout& layout, const TrainParams& params,
             unsigned threads)
      : tiles_(tiles), layout_(layout), params_(params), threads_(threads) {}

  void run(TrainingReport& report, ProgressSink& sink) {
    tryPairs(noPairs(), report);
    report.left_out_unary = report.left_out;
    if (!params_.pairwise) return;
    const PairSamples samples = pairSamples(tiles_, layout_.edge_columns.size(), params_);
    PairShape shape = shapeOf(samples);
    for (const float degree_power : params_.overlap_correction ? std::vector{0.5F, 1.0F} : std::vector{0.0F}) {
      shape.degree_power = degree_power;
      PairModel pairs = fitPairs(samples, shape);
      for (const float scale : {0.25F, 0.5F, 1.0F}) {
        pairs.pair_scale = scale;
        tryPairs(pairs, report);
      }
      sink.note("pairwise term, degree power " + std::to_string(degree_power) + ": best macro F1 so far " +
                std::to_string(best_));
    }
  }

 private:
  PairModel noPairs() const {
    PairModel pairs;
    pairs.knots.assign(layout_.edge_columns.size(), HatKnots{-1, 0, 1});
    pairs.weights.assign(1 + kHats * pairs.knots.size(), PairCosts{});
    return pairs;
  }

  PairShape shapeOf(const PairSamples& samples) const {
    PairShape shape;
    shape.l2 = params_.pair_l2;
    for (std::size_t c = 0; c < samples.columns; ++c) {
      std::vector<float> values;
      for (std::size_t e = c; e < samples.features.size(); e += samples.columns) values.push_back(samples.features[e]);
      shape.knots.push_back(knotsOf(std::move(values)));
      const bool overlap = layout_.edge_columns[c].find("overlap") != std::string::npos;
      shape.columns_used.push_back(params_.overlap_correction || !overlap);
    }
    return shape;
  }

  void tryPairs(const PairModel& pairs, TrainingReport& report) {
    const CalibrationRows rows = inferTiles(tiles_, pairs, params_.labelling, threads_);
    const Calibration calibration = fitCalibration(rows);
    const LabelScores scores = scoresOf(rows, calibration);
    if (scores.macroF1() <= best_) return;
    best_ = scores.macroF1();
    report.model.pairs = pairs;
    report.model.calibration = calibration;
    report.left_out = scores;
    report.calibration_error = calibrationErrorOf(rows, calibration);
    report.calibration_error_before = calibrationErrorOf(rows, Calibration{});
  }

  const std::vector<ScoredTile>& tiles_;
  const FeatureLayout& layout_;
  const TrainParams& params_;
  unsigned threads_;
  double best_ = -1;
};

/// Tiles of every group, scored by a unary that was trained on the other groups.
std::vector<ScoredTile> leaveOut(const PlaceRefs& places, const FeatureLayout& layout, const TrainParams& params,
                                 unsigned threads, ProgressSink& sink) {
  const std::set<int> groups = groupsOf(places);
  if (groups.size() < 2)
    throw InputError(SourceLocation{},
                     "training needs scans of two places at least, to measure on what it has not seen",
                     "give more scans, or put them into groups that lie apart");
  std::vector<ScoredTile> tiles;
  std::size_t done = 0;
  for (const int group : groups) {
    sink.progress("unary terms that leave a group out", done++, groups.size());
    const TreeEnsemble unary = trainUnary(placesWithout(places, group), layout, params, threads);
    for (ScoredTile& tile : scoreTiles(scoredPlaces(places, group), unary, params.labelling, threads))
      tiles.push_back(std::move(tile));
  }
  return tiles;
}

TrainingReport trainOn(const PlaceRefs& places, const PerceptionParams& perception, const TrainParams& params,
                       unsigned threads, ProgressSink& sink) {
  TrainingReport report;
  report.model.perception = perception;
  report.model.layout = featureLayout(perception.features);
  const std::vector<ScoredTile> tiles = leaveOut(places, report.model.layout, params, threads, sink);
  PairSearch(tiles, report.model.layout, params, threads).run(report, sink);
  if (report.left_out.points() == 0)
    throw InputError(SourceLocation{}, "the training scans have no point of known truth", "check the label map");
  report.model.unary = trainUnary(places, report.model.layout, params, threads);
  return report;
}

/// The model's provenance. The hash identifies the features and truth of the training.
std::map<std::string, std::string> provenanceOf(std::span<const TrainingPlace> places) {
  std::size_t measured = 0, cluxels = 0;
  ContentHasher hasher;
  for (const TrainingPlace& place : places) {
    measured += place.only_for_training ? 0 : 1;
    hasher.addText(place.name).add(place.group);
    for (const auto& [key, tile] : place.features) {
      cluxels += tile.size();
      hasher.addText(toBytes(tile));
    }
    for (const auto& [key, counts] : place.truth)
      for (const TruthCounts& of_labels : counts) hasher.addSpan(std::span<const TruthCounts::value_type>(of_labels));
  }
  return {{"places measured on when left out", std::to_string(measured)},
          {"places that only help", std::to_string(places.size() - measured)},
          {"cluxels", std::to_string(cluxels)},
          {"features and truth", hasher.finish().hex()}};
}

PlaceRefs refsOf(std::span<const TrainingPlace> places) {
  PlaceRefs refs;
  for (const TrainingPlace& place : places) refs.push_back(&place);
  return refs;
}

Evaluation evaluateOn(const LabelModel& model, const PlaceRefs& places, const LabellingParams& params,
                      unsigned threads) {
  const std::vector<ScoredTile> tiles = scoreTiles(places, model.unary, params, threads);
  const CalibrationRows rows = inferTiles(tiles, model.pairs, params, threads);
  return {scoresOf(rows, model.calibration), calibrationErrorOf(rows, model.calibration)};
}

}  // namespace

TrainingReport train(const std::string& name, std::span<const TrainingPlace> places, const PerceptionParams& perception,
                     const TrainParams& params, unsigned threads, ProgressSink& sink) {
  TrainingReport report = trainOn(refsOf(places), perception, params, threads, sink);
  report.model.name = name;
  report.model.provenance = provenanceOf(places);
  return report;
}

Evaluation evaluate(const LabelModel& model, std::span<const TrainingPlace> places, const LabellingParams& params,
                    unsigned threads) {
  PlaceRefs refs = refsOf(places);
  std::erase_if(refs, [](const TrainingPlace* place) { return place->only_for_training; });
  return evaluateOn(model, refs, params, threads);
}

}  // namespace cluxel::perception
