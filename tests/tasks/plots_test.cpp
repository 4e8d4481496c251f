// SPDX-License-Identifier: Apache-2.0
// Figures: their markup is well formed, loads nothing, and shows the numbers of the JSON forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <random>

#include "tasks/campus_map_fixture.hpp"
#include "tasks/plots/evaluation_plots.hpp"
#include "tasks/plots/map_plots.hpp"

namespace cluxel::tasks {
namespace {

using PlotJson = nlohmann::json;
using TextRows = std::vector<std::vector<std::string>>;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// A page as a parser that is not ours reads it.
struct ParsedPage {
  pugi::xml_document document;

  explicit ParsedPage(const std::string& page) {
    const auto read = document.load_string(page.c_str(), pugi::parse_default | pugi::parse_ws_pcdata);
    EXPECT_TRUE(read) << read.description() << " at " << page.substr(static_cast<std::size_t>(read.offset), 60);
  }
  pugi::xml_node section(const std::string& id) const {
    return document.select_node(("//section[@id='" + id + "']").c_str()).node();
  }
  TextRows rowsOf(const std::string& id) const {
    TextRows rows;
    for (const auto& row : section(id).select_nodes(".//tbody/tr")) {
      rows.emplace_back();
      for (const pugi::xml_node& cell : row.node().children()) rows.back().emplace_back(cell.child_value());
    }
    return rows;
  }
  std::size_t count(const std::string& id, const std::string& path) const {
    return section(id).select_nodes(path.c_str()).size();
  }
};

/// Counts that no two cells share, with all kinds of objects.
MapEvaluation madeEvaluation() {
  MapEvaluation made{
      ConfusionMatrix({"column", "scatter"}), ConfusionMatrix({"Tree", "Lamp & <b>", "Car"}), true, {}, {}};
  for (std::size_t i = 0; i < 6; ++i) made.primitives.counts[i] = 10 + i;
  for (std::size_t i = 0; i < 8; ++i) made.objects.counts[i] = 100 + 7 * i;  // no truth of Car
  for (std::size_t i = 8; i < 12; ++i) made.objects.counts[i] = 0;
  made.by_points = {{"Tree", 4, 5, 3, 3}, {"Lamp & <b>", 2, 1, 0, 0}, {"Car", 0, 0, 0, 0}};
  made.by_box = made.by_points;
  const std::vector<std::pair<double, bool>> trees{{0.9, true}, {0.4, false}, {0.8, true}, {0.8, false}, {0.55, true}};
  for (const auto& [confidence, right] : trees) {
    made.judged.push_back({0, 0, confidence, right});
    made.calibration.add(confidence, right);
  }
  made.judged.push_back({0, 1, 0.7, false});
  return made;
}

TEST(Plots, PrecisionAndRecallAreCountsAboveEachConfidence) {
  const MapEvaluation made = madeEvaluation();
  for (std::size_t name = 0; name < 3; ++name) {
    const auto curve = made.precisionRecallOf(name);
    for (const PrecisionRecall& point : curve) {
      std::uint64_t answers = 0, right = 0;
      for (const JudgedAnswer& judged : made.judged)
        if (judged.class_number == name && judged.confidence >= point.confidence) ++answers, right += judged.is_right;
      EXPECT_EQ(point.answers, answers);
      EXPECT_EQ(point.right, right);
      EXPECT_DOUBLE_EQ(point.precision, double(right) / double(answers));
      EXPECT_DOUBLE_EQ(point.recall, double(right) / double(made.by_points[name].truth));
    }
  }
  EXPECT_EQ(made.precisionRecallOf(0).size(), 4U) << "two trees are equally sure";
  EXPECT_TRUE(made.precisionRecallOf(2).empty()) << "there is no true car";
}

TEST(Plots, TheLastPointOfACurveIsTheScoreOfTheMap) {
  const MapEvaluation made = madeEvaluation();
  EXPECT_DOUBLE_EQ(made.precisionRecallOf(0).back().precision, made.by_points[0].precision());
  EXPECT_DOUBLE_EQ(made.precisionRecallOf(0).back().recall, made.by_points[0].recall());
}

TEST(Plots, TablesOfAnEvaluationHoldTheNumbersOfItsJson) {
  const MapEvaluation made = madeEvaluation();
  const PlotJson json = PlotJson::parse(toJson(made));
  const ParsedPage page(plotPage(evaluationPlots(made, {"campus.clx"})));
  const TextRows confusion = page.rowsOf("confusion-objects");
  ASSERT_EQ(confusion.size(), 2U);
  for (std::size_t row = 0; row < 2; ++row) {
    const PlotJson& truth = json.at("objects_by_point").at("classes")[row];
    EXPECT_EQ(confusion[row][0], truth.at("class"));
    std::size_t column = 1;
    for (const char* name : {"Tree", "Lamp & <b>", "Car", "none"})
      EXPECT_EQ(confusion[row].at(column++), std::to_string(truth.at("answers").at(name).get<int>()));
  }
  const TextRows classes = page.rowsOf("classes-primitives");
  ASSERT_EQ(classes.size(), 2U);
  for (std::size_t row = 0; row < 2; ++row) {
    const PlotJson& known = json.at("primitives_by_point").at("classes")[row];
    EXPECT_EQ(classes[row][1], plotNumber(known.at("precision")));
    EXPECT_EQ(classes[row][4], plotNumber(known.at("iou")));
  }
  TextRows curve;
  for (const PlotJson& of_class : json.at("precision_recall"))
    for (const PlotJson& point : of_class.at("points"))
      curve.push_back({of_class.at("class"), plotNumber(point.at("confidence")),
                       std::to_string(point.at("answers").get<int>()), std::to_string(point.at("right").get<int>()),
                       plotNumber(point.at("precision")), plotNumber(point.at("recall"))});
  EXPECT_EQ(page.rowsOf("precision-recall"), curve);
  const TextRows bins = page.rowsOf("calibration");
  std::size_t row = 0;
  for (const PlotJson& bin : json.at("calibration").at("bins"))
    if (bin.at("objects") > 0) {
      EXPECT_EQ(bins.at(row++)[2], std::to_string(bin.at("right").get<int>()));
    }
  EXPECT_EQ(row, bins.size());
}

TEST(Plots, DrawingsHaveAMarkForEachNumber) {
  const MapEvaluation made = madeEvaluation();
  const ParsedPage page(plotPage(evaluationPlots(made, {"a", "b"})));
  EXPECT_EQ(page.count("confusion-objects", ".//rect"), 2U * 4U);
  EXPECT_EQ(page.count("precision-recall", ".//path[@class='curve']"), 2U);
  EXPECT_EQ(page.count("calibration", ".//circle"), page.rowsOf("calibration").size());
  // The opacity of a cell is its share of the row.
  const pugi::xml_node cell = page.section("confusion-objects").select_node(".//rect").node();
  EXPECT_NEAR(cell.attribute("fill-opacity").as_double(), 100.0 / (100 + 107 + 114 + 121), 1e-3);
}

TEST(Plots, TextsNeverBecomeMarkupAndNothingIsLoaded) {
  const std::string evil = "</title><script>alert(1)</script>\"'&\x01\xff";
  MapEvaluation made = madeEvaluation();
  made.objects.names[0] = made.by_points[0].name = evil;
  const std::string text = plotPage(evaluationPlots(made, {evil}));
  EXPECT_THAT(text, Not(HasSubstr("<script")));
  const ParsedPage page(text);
  EXPECT_THAT(page.rowsOf("confusion-objects")[0][0], HasSubstr("</title><script>alert(1)</script>\"'&"));
  for (const char* loads : {"//script", "//link", "//img", "//iframe", "//@src", "//@href", "//@onload"})
    EXPECT_TRUE(page.document.select_nodes(loads).empty()) << loads;
  EXPECT_THAT(text, HasSubstr("default-src 'none'"));
}

TEST(Plots, ImagesAndTablesHaveNamesForScreenReaders) {
  const ParsedPage page(plotPage(evaluationPlots(madeEvaluation(), {"campus.clx"})));
  EXPECT_STREQ(page.document.child("html").attribute("lang").value(), "en");
  EXPECT_GE(page.document.select_nodes("//svg").size(), 5U);
  for (const auto& image : page.document.select_nodes("//svg")) {
    EXPECT_STREQ(image.node().attribute("role").value(), "img");
    EXPECT_STRNE(image.node().attribute("aria-label").value(), "");
  }
  for (const auto& section : page.document.select_nodes("//section")) {
    EXPECT_EQ(section.node().select_nodes(".//table/caption").size(), 1U) << section.node().attribute("id").value();
    EXPECT_EQ(section.node().attribute("aria-labelledby").value(),
              std::string(section.node().child("h2").attribute("id").value()));
  }
}

TEST(Plots, QuartilesSplitTheValuesIntoFourParts) {
  std::mt19937 random(7);
  for (const std::size_t count : {1U, 2U, 3U, 4U, 5U, 8U, 101U}) {
    std::vector<double> values(count);
    for (double& value : values) value = std::uniform_real_distribution<double>(0, 20)(random);
    const PlotSpread spread = spreadOf("x", values);
    EXPECT_EQ(spread.count, count);
    EXPECT_EQ(spread.least, *std::min_element(values.begin(), values.end()));
    EXPECT_EQ(spread.most, *std::max_element(values.begin(), values.end()));
    const auto below = [&](double limit) {
      return std::count_if(values.begin(), values.end(), [&](double value) { return value < limit; });
    };
    const auto up_to = [&](double limit) {
      return std::count_if(values.begin(), values.end(), [&](double value) { return value <= limit; });
    };
    for (const auto& [value, share] :
         {std::pair{spread.lower, 0.25}, std::pair{spread.middle, 0.5}, std::pair{spread.upper, 0.75}}) {
      EXPECT_LE(double(below(value)), share * double(count - 1) + 1) << count;
      EXPECT_GE(double(up_to(value)), share * double(count - 1)) << count;
    }
  }
  EXPECT_EQ(spreadOf("x", {}).count, 0U);
}

TEST(CampusMapPage, FiguresOfAMapHoldItsObjectsHeightsAndRuns) {
  const CampusMap& campus = CampusMap::shared();
  const MapFigures figures = mapFigures(campus.map());
  const ParsedPage page(plotPage(mapPlots(figures, "campus")));
  std::map<std::string, std::vector<double>> heights;
  const auto boxes = campus.boxesInRdf();
  for (const auto& object : campus.map().objects()) {
    const auto box = boxes.at(object.id.hex()).sizes();
    heights[localName(object.class_iri)].push_back(box.z());
  }
  const TextRows rows = page.rowsOf("heights"), objects = page.rowsOf("objects");
  ASSERT_EQ(rows.size(), heights.size());
  std::size_t i = 0;
  for (auto& [name, values] : heights) {
    EXPECT_THAT(objects[i], ElementsAre(name, std::to_string(values.size())));
    EXPECT_EQ(rows[i][0], name);
    EXPECT_EQ(rows[i][1], std::to_string(values.size()));
    // Boxes stand upright: their height is the extent of the object along z.
    EXPECT_NEAR(std::stod(rows[i][6]), *std::max_element(values.begin(), values.end()), 2e-3) << name;
    ++i;
  }
  ASSERT_EQ(figures.runs.size(), 1U);
  EXPECT_EQ(figures.runs[0].operation, "build");
  EXPECT_EQ(figures.runs[0].scans, campus.map().clouds().size());
  EXPECT_GT(figures.runs[0].seconds, 0);
  double sum_s = 0;
  std::vector<std::string> stages;
  for (const auto& [name, seconds] : figures.runs[0].stages) sum_s += seconds, stages.push_back(name);
  for (const char* stage : {"scans", "labels", "objects", "facts"}) EXPECT_THAT(stages, ::testing::Contains(stage));
  EXPECT_LE(sum_s, figures.runs[0].seconds + 0.01 * double(stages.size())) << "stages follow each other";
  EXPECT_EQ(page.rowsOf("run-1").size(), stages.size());
}

}  // namespace
}  // namespace cluxel::tasks
