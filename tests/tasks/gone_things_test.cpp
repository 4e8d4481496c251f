// SPDX-License-Identifier: Apache-2.0
// What tasks, shipped questions and exports tell of things that later scans show to be gone.
#include "tasks/gone_things.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/query_engine.hpp"
#include "tasks/ask/inventory_task.hpp"
#include "tasks/box_visits.hpp"
#include "tasks/explanation.hpp"
#include "tasks/export/map_export.hpp"
#include "tasks/query_source.hpp"

namespace cluxel::tasks {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

/// Three cars in a row on the first visit, of which one has left on the second.
class GoneThings : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const Box north = boxFrom({-15, 10, 0}, {15, 10.5, 5}), south = boxFrom({-15, -12.5, 0}, {15, -12, 5});
    const Box stays = boxFrom({-5, 4, 0.25}, {-0.8, 5.8, 1.5}), leaves = boxFrom({2, 4, 0.25}, {6.2, 5.8, 1.5});
    const Box stays_too = boxFrom({8.5, 4, 0.25}, {12.7, 5.8, 1.5});
    const std::vector<Eigen::Vector3d> sensors{{-3, 0, 1.8}, {1, -1, 1.8}, {5, 0, 1.8}, {8, 1, 1.8}};
    folder = new rdf::ScratchFolder;
    writeVisits({{{north, south, stays, stays_too, leaves}, sensors}, {{north, south, stays, stays_too}, sensors}},
                folder->path() / "scans");
    mapping::buildMap(mapping::scansOf({folder->path() / "scans"}), mapping::shippedInputs(),
                      folder->path() / "map.clx", {}, mapping::silence());
    map.emplace(folder->path() / "map.clx");
    for (const rules::SemanticObject& object : map->objects()) {
      const std::string iri = rdf::iriOfObject(object.id);
      if (const auto time = seenThrough(map->quads(), iri)) gone = iri, gone_at = *time;
    }
  }
  static void TearDownTestSuite() {
    map.reset();
    delete folder;
  }
  static sparql::ResultTable answer(const Question& question) {
    std::vector<std::string> names;
    const std::vector<sparql::Binding> bindings = bindingsFor(question, {});
    for (const sparql::Binding& binding : bindings) names.push_back(binding.first);
    return sparql::PreparedQuery(map->quads(), question.text, {}, names).evaluate(bindings).table;
  }
  static std::string textOf(const Term* term) { return term == nullptr ? "" : term->text; }

  inline static rdf::ScratchFolder* folder = nullptr;
  inline static std::optional<mapping::MapReader> map;
  inline static std::string gone, gone_at;
};

TEST_F(GoneThings, AreLeftOutOfWhatStandsAndMarkedInLists) {
  ASSERT_FALSE(gone.empty());
  const std::set<std::string> about_the_past{"seen_from"};
  std::size_t marked = 0;
  for (const Question& question : shippedQuestions(DataHome(test::sourceFolder()))) {
    const sparql::ResultTable table = answer(question);
    const auto named = std::find(table.variables.begin(), table.variables.end(), "seenThrough");
    for (std::size_t row = 0; row < table.row_count; ++row) {
      bool is_about_it = false;
      for (std::size_t column = 0; column < table.variables.size(); ++column)
        is_about_it = is_about_it || textOf(table.at(row, column)) == gone;
      if (named != table.variables.end()) {
        const auto column = static_cast<std::size_t>(named - table.variables.begin());
        EXPECT_EQ(textOf(table.at(row, column)), is_about_it ? gone_at : "") << question.file;
        marked += is_about_it;
      } else {
        EXPECT_TRUE(!is_about_it || about_the_past.contains(question.file.stem())) << question.file;
      }
    }
  }
  EXPECT_GE(marked, 1U) << "the list of all objects has it";
}

TEST_F(GoneThings, AreCountedBesideTheOthersOfTheirClass) {
  const sparql::ResultTable table = answer(readQuestion(test::sourceFolder() / "queries/count_by_class.rq"));
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(table.variables.begin(), table.variables.end(), name) -
                                    table.variables.begin());
  };
  std::size_t all = 0;
  for (std::size_t row = 0; row < table.row_count; ++row) all += std::stoul(textOf(table.at(row, column("gone"))));
  EXPECT_EQ(all, 1U);
}

TEST_F(GoneThings, LeaveNoRowOfTwoInInventories) {
  const rdf::QuadReader& quads = map->quads();
  const std::string row = "ASK { ?row a <" + rdf::vocabulary::clx("ParkingRow") + "> ; <" +
                          rdf::vocabulary::clx("hasMember") + "> <" + gone + "> }";
  ASSERT_TRUE(sparql::evaluateQuery(quads, row, {}).boolean) << "the rules make one of all three";
  InventoryParams rows{.classes = {}};
  rows.with_sidewalks = false;
  const std::vector<std::string> left_out{"without 1 objects of all classes that later scans show to be gone",
                                          "without 1 parking rows of which fewer than three vehicles are left"};
  const TaskAnswer inventory = inventoryAnswer(*map, rows, {});
  EXPECT_TRUE(inventory.rows.empty());
  EXPECT_EQ(inventory.notes, left_out);
  const TaskAnswer compared = registerAnswer(*map, rows, {}, {});
  EXPECT_TRUE(compared.rows.empty());
  EXPECT_THAT(compared.notes, testing::IsSupersetOf(left_out));
  EXPECT_EQ(inventoryOf(*map, rows).rows_left_out, 1U);
  rows.with_rows = false;
  EXPECT_EQ(inventoryOf(*map, rows).rows_left_out, 0U);
  const std::vector<RegisterEntry> entries{
      {.id = "a", .class_iri = rdf::vocabulary::clx("ParkingRow"), .height_m = {}}};
  EXPECT_EQ(registerItems(*map, rows, entries).rows_left_out, 1U) << "the rows that entries mean";
}

/// Rules and updates may state anything of a thing; that it is gone only rays tell.
TEST_F(GoneThings, AreThoseThatTheMapObserved) {
  const auto there = std::find_if(map->objects().begin(), map->objects().end(), [&](const auto& object) {
    return rdf::iriOfObject(object.id) != gone && object.class_iri == rdf::vocabulary::clx("Vehicle");
  });
  ASSERT_NE(there, map->objects().end());
  const std::string standing = rdf::iriOfObject(there->id);
  const auto file = folder->path() / "stated.clx";
  std::filesystem::copy_file(folder->path() / "map.clx", file);
  {
    rdf::WriteTransaction transaction = rdf::Environment::open(file, rdf::OpenMode::ReadWrite)->write();
    rdf::QuadWriter writer(transaction);
    for (const std::string_view graph : {rdf::vocabulary::kGraphInferred, std::string_view("https://example.org/more")})
      writer.add({Term::iri(standing), Term::iri(rdf::vocabulary::clx("seenThrough")),
                  Term::literal(gone_at, "http://www.w3.org/2001/XMLSchema#dateTime"), Term::iri(std::string(graph))});
    writer.flush();
    transaction.commit();
  }
  const mapping::MapReader stated(file);
  EXPECT_EQ(goneAmong(stated), goneAmong(*map));
  EXPECT_EQ(seenThrough(stated.quads(), standing), std::nullopt);
  EXPECT_EQ(seenThrough(stated.quads(), gone), gone_at);
}

TEST_F(GoneThings, AreMarkedInFootprintsAndExplanations) {
  std::string text;
  exportMap(
      *map, ExportFormat::GeoJson, [&](std::string_view piece) { text.append(piece); }, ExportFrame::Local);
  const Json collection = Json::parse(text);
  for (const Json& feature : collection.at("features")) {
    const Json& properties = feature.at("properties");
    EXPECT_EQ(properties.value("seenThrough", ""), properties.at("iri") == gone ? gone_at : "");
  }
  const ExplanationTexts told = explainThing(*map, gone);
  EXPECT_THAT(told.text, HasSubstr("gone: a scan at " + gone_at + " saw through its place\n"));
  EXPECT_EQ(Json::parse(told.json).at("seenThrough"), gone_at);
}

}  // namespace
}  // namespace cluxel::tasks
