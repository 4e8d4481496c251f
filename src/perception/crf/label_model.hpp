// SPDX-License-Identifier: Apache-2.0
// A trained model, stored as JSON: everything needed to compute labels and probabilities from features of cluxels.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "perception/crf/crf_pairs.hpp"
#include "perception/crf/unary_trees.hpp"
#include "perception/features/feature_tile.hpp"

namespace cluxel::perception {

inline constexpr int kModelVersion = 2;

/// From the CRF's marginals to probabilities and a label: p = softmax(slope * log(marginal) + offset), and the label is
/// the largest p * favour: for a good macro F1, a rare label is chosen at less than the largest probability.
struct Calibration {
  float slope = 1;
  LabelValues offset{};
  LabelValues favour{1, 1, 1, 1, 1};
};

struct LabelModel {
  std::string name;             ///< "oakland"
  PerceptionParams perception;  ///< settings of the stages that computed the features
  FeatureLayout layout;         ///< columns that the trees and the pairwise term read
  TreeEnsemble unary;
  PairModel pairs;
  Calibration calibration;
  std::map<std::string, std::string> provenance;  ///< what it was trained on and how; informative only
};

/// The model as JSON text. Equal models give equal bytes.
std::string modelText(const LabelModel& model);

/// Reads what modelText() wrote. Throws InputError naming `file` and what is wrong in it: not JSON, a newer version, a
/// missing field, a number that is not finite, an unknown column, features computed in another way.
LabelModel parseModel(std::string_view text, const std::string& file);

/// Reads the file `path`, or `path`/model.json when it is a folder.
LabelModel loadModel(const std::filesystem::path& path);
void saveModel(const LabelModel& model, const std::filesystem::path& path);

}  // namespace cluxel::perception
