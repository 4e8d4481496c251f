// SPDX-License-Identifier: Apache-2.0
// A trained model: everything that turns features of cluxels into labels with probabilities. One JSON text holds it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "cluxel/perception/crf_pairs.hpp"
#include "cluxel/perception/tile_pipeline.hpp"
#include "cluxel/perception/unary_trees.hpp"

namespace cluxel {

inline constexpr int kModelVersion = 1;

/// From the CRF's marginals to probabilities and a label: p = softmax(slope * log(marginal) + offset), and the label is
/// the largest p * favour. A rare label may be the better answer before it is the more probable one.
struct Calibration {
  float slope = 1;
  LabelValues offset{};
  LabelValues favour{1, 1, 1, 1, 1};
};

struct LabelModel {
  std::string name;             ///< "oakland"
  PerceptionParams perception;  ///< settings of the stages before, which the features were made with
  FeatureLayout layout;         ///< columns that the trees and the pairs read
  TreeEnsemble unary;
  PairModel pairs;
  Calibration calibration;
  std::map<std::string, std::string> provenance;  ///< what it was trained on and how, for people
};

/// The model as JSON text: equal models give equal bytes.
std::string modelText(const LabelModel& model);

/// Reads what modelText() wrote. Throws InputError naming `file` and what is wrong in it: not JSON, a newer version, a
/// missing field, a number that is not finite, a column that does not exist, features made in another way.
LabelModel parseModel(std::string_view text, const std::string& file);

/// Finds `path`, or `path`/model.json when it is a folder.
LabelModel loadModel(const std::filesystem::path& path);
void saveModel(const LabelModel& model, const std::filesystem::path& path);

}  // namespace cluxel
