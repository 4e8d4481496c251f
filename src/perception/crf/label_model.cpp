// SPDX-License-Identifier: Apache-2.0
// A model as JSON: trees as arrays of numbers, leaves as integer multiples of a step. Reading checks every field.
#include "perception/crf/label_model.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/file_bytes.hpp"
#include "base/json/json_fault.hpp"
#include "cluxel/error.hpp"
#include "perception/crf/model_settings.hpp"
#include "perception/training/unary_training.hpp"

namespace cluxel::perception {

namespace {

using Json = nlohmann::ordered_json;

Json treeJson(const ObliviousTree& tree) {
  Json columns = Json::array(), thresholds = Json::array(), leaves = Json::array();
  for (const TreeSplit& split : tree.splits) {
    columns.push_back(split.column);
    thresholds.push_back(split.threshold);
  }
  for (const LabelValues& leaf : tree.leaves)
    for (const float value : leaf) leaves.push_back(static_cast<int>(std::lround(value / kLeafStep)));
  return {{"columns", columns}, {"above", thresholds}, {"leaves", leaves}};
}

Json pairsJson(const PairModel& pairs) {
  return {{"unary_scale", pairs.unary_scale},
          {"pair_scale", pairs.pair_scale},
          {"degree_power", pairs.degree_power},
          {"knots", pairs.knots},
          {"weights", pairs.weights}};
}

[[noreturn]] void refuse(const std::string& file, const std::string& what) {
  throw InputError(SourceLocation{.file = file}, what,
                   "train the model again, or take one that comes with this program");
}

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

float finite(const Json& json) {
  require(json.is_number(), "a number is missing");
  const auto value = json.get<float>();
  require(std::isfinite(value), "a number is not finite");
  return value;
}

/// Limit of factors and offsets, so that costs stay finite.
float moderate(const Json& json) {
  const float value = finite(json);
  require(std::abs(value) < 1e12F, "a number is too great to compute with");
  return value;
}

template <std::size_t n>
std::array<float, n> moderateArray(const Json& json) {
  require(json.is_array() && json.size() == n, "an array has a wrong length");
  std::array<float, n> values;
  for (std::size_t i = 0; i < n; ++i) values[i] = moderate(json[i]);
  return values;
}

ObliviousTree treeOf(const Json& json, std::size_t columns) {
  const Json &split_columns = json.at("columns"), &thresholds = json.at("above"), &leaves = json.at("leaves");
  require(split_columns.is_array() && split_columns.size() <= kMaxTreeDepth, "a tree is too deep");
  require(thresholds.is_array() && thresholds.size() == split_columns.size(), "a tree lacks thresholds");
  const std::size_t count = std::size_t{1} << split_columns.size();
  require(leaves.is_array() && leaves.size() == count * scan::kPrimitiveLabelCount,
          "a tree has a wrong number of leaves");
  ObliviousTree tree;
  for (std::size_t d = 0; d < split_columns.size(); ++d) {
    require(split_columns[d].is_number_unsigned(), "a tree's column is not a whole number");
    const auto column = split_columns[d].get<std::uint64_t>();
    require(column < columns, "a tree reads a column that does not exist");
    tree.splits.push_back({static_cast<std::uint32_t>(column), finite(thresholds[d])});
  }
  tree.leaves.resize(count);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    require(leaves[i].is_number_integer() && std::abs(leaves[i].get<double>()) < 1e6,
            "a leaf is not a small whole number");
    tree.leaves[i / scan::kPrimitiveLabelCount][i % scan::kPrimitiveLabelCount] = leaves[i].get<float>() * kLeafStep;
  }
  return tree;
}

TreeEnsemble ensembleOf(const Json& json, std::size_t columns) {
  TreeEnsemble ensemble;
  ensemble.columns = static_cast<std::uint32_t>(columns);
  ensemble.bias = moderateArray<scan::kPrimitiveLabelCount>(json.at("bias"));
  require(json.at("trees").is_array(), "the trees are not a list");
  for (const Json& tree : json.at("trees")) ensemble.trees.push_back(treeOf(tree, columns));
  return ensemble;
}

PairModel pairsOf(const Json& json, std::size_t columns) {
  PairModel pairs;
  pairs.unary_scale = moderate(json.at("unary_scale"));
  pairs.pair_scale = moderate(json.at("pair_scale"));
  pairs.degree_power = finite(json.at("degree_power"));
  require(pairs.pair_scale >= 0, "pair_scale is negative");
  require(pairs.degree_power >= 0 && pairs.degree_power <= 4, "degree_power is not from 0 to 4");
  const Json &knots = json.at("knots"), &weights = json.at("weights");
  require(knots.is_array() && knots.size() == columns, "the pairwise term fits other edge columns");
  require(weights.is_array() && weights.size() == 1 + kHats * columns,
          "the pairwise term has a wrong number of weights");
  for (const Json& row : knots) {
    pairs.knots.push_back(moderateArray<kHats>(row));
    const HatKnots& knot = pairs.knots.back();
    require(knot[0] < knot[1] && knot[1] < knot[2], "knots are not ascending");
  }
  for (const Json& row : weights) pairs.weights.push_back(moderateArray<kLabelPairCount>(row));
  return pairs;
}

Calibration calibrationOf(const Json& json) {
  Calibration calibration;
  calibration.slope = moderate(json.at("slope"));
  calibration.offset = moderateArray<scan::kPrimitiveLabelCount>(json.at("offset"));
  calibration.favour = moderateArray<scan::kPrimitiveLabelCount>(json.at("favour"));
  for (const float favour : calibration.favour) require(favour > 0, "a label's favour is not above 0");
  return calibration;
}

FeatureLayout layoutOf(const Json& json, const PerceptionParams& perception) {
  FeatureLayout layout{json.at("columns").get<std::vector<std::string>>(),
                       json.at("edge_columns").get<std::vector<std::string>>()};
  require(layout.hash().hex() == json.at("hash").get<std::string>(), "the features' hash does not fit their names");
  require(layout.hash() == featureLayout(perception.features).hash(),
          "this program makes other features than the model reads");
  return layout;
}

LabelModel modelOf(const Json& json) {
  for (const char* section : {"perception", "features", "unary", "pairs", "calibration", "provenance"})
    if (!json.contains(section) || !json.at(section).is_object())
      throw std::invalid_argument("'" + std::string(section) + "' is missing or no object {…}");
  LabelModel model;
  model.name = json.at("name").get<std::string>();
  require(json.at("labels") == Json(scan::kPrimitiveLabelNames), "the labels are not those of this program");
  model.perception = perceptionSettingsFrom(json.at("perception"));
  model.layout = layoutOf(json.at("features"), model.perception);
  model.unary = ensembleOf(json.at("unary"), model.layout.columns.size());
  model.pairs = pairsOf(json.at("pairs"), model.layout.edge_columns.size());
  model.calibration = calibrationOf(json.at("calibration"));
  model.provenance = json.at("provenance").get<std::map<std::string, std::string>>();
  return model;
}

}  // namespace

std::string modelText(const LabelModel& model) {
  Json trees = Json::array();
  for (const ObliviousTree& tree : model.unary.trees) trees.push_back(treeJson(tree));
  const Calibration& calibration = model.calibration;
  const Json head{
      {"format", "cluxel label model"},
      {"version", kModelVersion},
      {"name", model.name},
      {"labels", scan::kPrimitiveLabelNames},
      {"provenance", model.provenance},
      {"perception", perceptionSettings(model.perception)},
      {"features",
       {{"hash", model.layout.hash().hex()},
        {"columns", model.layout.columns},
        {"edge_columns", model.layout.edge_columns}}},
      {"calibration", {{"slope", calibration.slope}, {"offset", calibration.offset}, {"favour", calibration.favour}}},
      {"pairs", pairsJson(model.pairs)},
      {"unary", {{"bias", model.unary.bias}, {"trees", trees}}}};
  return head.dump() + "\n";
}

LabelModel parseModel(std::string_view text, const std::string& file) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object()) refuse(file, "not a model: it is not a JSON object");
  try {
    require(json.at("format") == "cluxel label model", "not a model: its format has another name");
    const auto version = json.at("version").get<std::int64_t>();
    if (version != kModelVersion)
      refuse(file, "model of version " + std::to_string(version) + "; this program reads version " +
                       std::to_string(kModelVersion));
    return modelOf(json);
  } catch (const Json::exception& fault) {
    refuse(file, "faulty model: " + plainFault(fault));
  } catch (const std::invalid_argument& fault) {
    refuse(file, std::string("faulty model: ") + fault.what());
  }
}

LabelModel loadModel(const std::filesystem::path& path) {
  const std::filesystem::path file = std::filesystem::is_directory(path) ? path / "model.json" : path;
  return parseModel(readFile(file), file.string());
}

void saveModel(const LabelModel& model, const std::filesystem::path& path) {
  writeFile(path, modelText(model));
}

}  // namespace cluxel::perception
