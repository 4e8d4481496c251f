// SPDX-License-Identifier: Apache-2.0
// The labelling stage and the model file.
#include "perception/crf/labelling.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "cluxel/error.hpp"
#include "perception/labelling_fixture.hpp"

namespace cluxel::perception {

using namespace scan;
namespace {

const LabelModel& sharedModel() {
  static const LabelModel model = made_up::model();
  return model;
}

LabelTile labelled(const TrainingPlace& place, TileKey key, const LabellingParams& params = {}) {
  return TileLabeller(sharedModel()).label(ringIn(place.features, key), params);
}

TEST(Labelling, GivesEachCluxelALabelAndProbabilitiesThatSumToOne) {
  const TrainingPlace place = made_up::place(5, 0);
  const LabelTile tile = labelled(place, {0, 0});
  ASSERT_EQ(tile.label.size(), place.features.at({0, 0}).size());
  for (std::size_t i = 0; i < tile.label.size(); ++i) {
    EXPECT_LT(tile.label[i], kPrimitiveLabelCount);
    float sum = 0;
    for (const float probability : tile.probability[i]) {
      EXPECT_GE(probability, 0.0F);
      sum += probability;
    }
    EXPECT_NEAR(sum, 1.0F, 1e-5F);
  }
}

TEST(Labelling, IsAFunctionOfItsArguments) {
  const TrainingPlace place = made_up::place(6, 0), copy = made_up::place(6, 0);
  EXPECT_EQ(toBytes(labelled(place, {1, 0})), toBytes(labelled(copy, {1, 0})));
}

TEST(Labelling, LooksNoFartherIntoTheRingThanTheHalo) {
  const TrainingPlace place = made_up::place(7, 0);
  TrainingPlace changed = place;
  FeatureTile& neighbour = changed.features.at({1, 0});
  const std::size_t columns = neighbour.features.size() / neighbour.size();
  for (std::size_t i = 0; i < neighbour.size(); ++i)
    if (neighbour.center[i].x() > 3.0F)
      std::fill_n(neighbour.features.begin() + static_cast<std::ptrdiff_t>(i * columns), columns, 9.0F);
  EXPECT_EQ(toBytes(labelled(place, {0, 0}, {.sweeps = 3, .halo_m = 2.0})),
            toBytes(labelled(changed, {0, 0}, {.sweeps = 3, .halo_m = 2.0})));
  EXPECT_NE(toBytes(labelled(place, {0, 0}, {.sweeps = 3, .halo_m = 8.0})),
            toBytes(labelled(changed, {0, 0}, {.sweeps = 3, .halo_m = 8.0})));
}

TEST(Labelling, LabelsAlikeWithANarrowAndAWideHalo) {
  const TrainingPlace place = made_up::place(8, 0);
  const LabelTile narrow = labelled(place, {0, 0}, {.sweeps = 3, .halo_m = 2.0}),
                  wide = labelled(place, {0, 0}, {.sweeps = 3, .halo_m = 16.0});
  std::size_t different = 0;
  for (std::size_t i = 0; i < narrow.label.size(); ++i)
    different += static_cast<std::size_t>(narrow.label[i] != wide.label[i]);
  EXPECT_LE(different, narrow.label.size() / 50);
}

TEST(Labelling, LabelsATileWithoutNeighboursAndAnEmptyOne) {
  TrainingPlace place = made_up::place(9, 0);
  place.features.erase({1, 0});
  EXPECT_EQ(labelled(place, {0, 0}).label.size(), 256U);
  FeatureTile empty;
  empty.edge_offset = empty.edge_row_offset = {0};
  Ring<FeatureTile> ring{};
  ring[kRingCentre] = &empty;
  EXPECT_TRUE(TileLabeller(sharedModel()).label(ring, {}).label.empty());
}

TEST(Labelling, ReadsBackWhatItStored) {
  const LabelTile tile = labelled(made_up::place(10, 0), {0, 0});
  const std::string bytes = toBytes(tile);
  EXPECT_EQ(toBytes(labelTileFromBytes(bytes)), bytes);
  EXPECT_THROW(labelTileFromBytes(bytes.substr(0, bytes.size() - 1)), Error);
  EXPECT_THROW(labelTileFromBytes(bytes + "x"), Error);
}

TEST(Calibration, FavoursALabelThatIsLessProbable) {
  const LabelValues marginals{0.5F, 0.1F, 0.3F, 0.05F, 0.05F};
  Calibration calibration;
  EXPECT_EQ(calibrate(calibration, marginals).label, 0);
  calibration.favour[2] = 2.0F;
  const CalibratedLabel favoured = calibrate(calibration, marginals);
  EXPECT_EQ(favoured.label, 2);
  EXPECT_NEAR(favoured.probability[2], 0.3F, 1e-5F);
}

TEST(LabelModel, ReadsBackWhatItWrote) {
  const std::string text = modelText(sharedModel());
  EXPECT_EQ(modelText(parseModel(text, "model.json")), text);
}

TEST(LabelModel, GivesTheSameLabelsAfterReadingBack) {
  const TrainingPlace place = made_up::place(11, 0);
  const LabelModel again = parseModel(modelText(sharedModel()), "model.json");
  EXPECT_EQ(toBytes(TileLabeller(again).label(ringIn(place.features, {0, 0}), {})), toBytes(labelled(place, {0, 0})));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(LabelModel, RefusesFaultyTextNamingTheFile) {
  const std::string text = modelText(sharedModel());
  const std::vector<std::string> faulty{"",
                                        "[]",
                                        "{}",
                                        text.substr(0, text.size() / 2),
                                        replaced(text, "\"version\":2", "\"version\":99"),
                                        replaced(text, "cluxel label model", "something else"),
                                        replaced(text, "\"slope\":", "\"slop\":"),
                                        replaced(text, "\"columns\":[", "\"columns\":[\"x\","),
                                        replaced(text, "\"above\":[", "\"above\":[1e999,"),
                                        replaced(text, "\"leaves\":[", "\"leaves\":[1,"),
                                        replaced(text, "\"knots\":[[", "\"knots\":[[0,0,0],["),
                                        replaced(text, "vertical_plane", "vertical"),
                                        replaced(text, "\"clustering.radius\":", "\"clustering.radius\":-"),
                                        replaced(text, "\"slope\":", "\"slope\":3e37,\"was\":"),
                                        replaced(text, "\"bias\":[", "\"bias\":[3e37,3e37,3e37,3e37,3e37],\"was\":["),
                                        replaced(text, "\"degree_power\":", "\"degree_power\":-1e30,\"was\":"),
                                        replaced(text, "\"unary_scale\":", "\"unary_scale\":3e37,\"was\":"),
                                        replaced(text, "\"calibration\":{", "\"calibration\":null,\"was\":{"),
                                        replaced(text, "\"trees\":[", "\"trees\":[null,"),
                                        replaced(text, "\"name\":", "\"name\":5,\"was\":")};
  for (const std::string& bad : faulty) {
    try {
      parseModel(bad, "bad.json");
      ADD_FAILURE() << "taken: " << bad.substr(0, 80);
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("bad.json"), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find("json.exception"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace cluxel::perception
