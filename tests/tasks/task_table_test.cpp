// SPDX-License-Identifier: Apache-2.0
// The table of tasks: every task answers with its columns, parameters and files of usual places are checked, answers
// have the same rows in all formats.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "base/file_bytes.hpp"
#include "tasks/ask/inventory_task.hpp"
#include "tasks/ask/task_table.hpp"
#include "tasks/campus_map_fixture.hpp"
#include "tasks/search/search_tour.hpp"

namespace cluxel::tasks {
namespace {

using TaskJson = nlohmann::json;

std::vector<Task> allTasks() {
  return tasksOf(shippedQuestions(DataHome(test::sourceFolder())));
}

/// Values for what a task requires.
NamedValues requiredOf(const Task& task) {
  NamedValues values;
  for (const TaskParameter& parameter : task.parameters)
    if (parameter.is_required)
      values.emplace_back(parameter.name, parameter.kind == TaskParameter::Kind::Class ? "StreetSign" : "0,0");
  return values;
}

std::string refusalOf(const Task& task, const NamedValues& given) {
  try {
    const TaskValues values(task.parameters, given);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(TaskTable, EveryTaskHasATitleAndDescribesItsParametersAndColumns) {
  const std::vector<Task> tasks = allTasks();
  const TaskJson listed = TaskJson::parse(taskListJson(tasks));
  ASSERT_EQ(listed.size(), tasks.size());
  for (const Task& task : tasks) {
    EXPECT_TRUE(task.title.ends_with("?") || !task.file.empty()) << task.name;
    EXPECT_FALSE(task.columns.empty()) << task.name;
    for (const TaskParameter& parameter : task.parameters) {
      EXPECT_FALSE(parameter.help.empty()) << task.name << " " << parameter.name;
      if (parameter.default_value.empty()) continue;
      Task alone;
      alone.parameters = {parameter};
      EXPECT_EQ(refusalOf(alone, {{parameter.name, parameter.default_value}}), "")
          << task.name << " " << parameter.name;
    }
    for (const QueryColumn& column : task.columns) {
      EXPECT_FALSE(column.unit.empty()) << task.name << " " << column.name;
      EXPECT_FALSE(column.help.empty()) << task.name << " " << column.name;
    }
  }
}

TEST(TaskTable, NamesTakeDashesAndUnderscoresAndFilesOfQuestions) {
  const std::vector<Task> tasks = allTasks();
  EXPECT_EQ(taskNamed(tasks, "street-signs").name, "street_signs");
  EXPECT_EQ(taskNamed(tasks, "street_signs.rq").name, "street_signs");
  try {
    taskNamed(tasks, "weather");
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("the tasks are route, reach"), std::string::npos) << error.what();
  }
}

TEST(TaskTable, FaultyValuesAreRefusedByName) {
  const std::vector<Task> tasks = allTasks();
  const Task& route = taskNamed(tasks, "route");
  const NamedValues good{{"from", "0,0"}, {"to", "1,1"}};
  EXPECT_EQ(refusalOf(route, good), "");
  const auto with = [&](const std::string& name, const std::string& value) {
    NamedValues values = good;
    values.emplace_back(name, value);
    return refusalOf(route, values);
  };
  EXPECT_NE(refusalOf(route, {{"from", "0,0"}}).find("to: it is missing"), std::string::npos);
  EXPECT_NE(with("widht", "1").find("did you mean 'width'"), std::string::npos);
  EXPECT_NE(with("width", "-1").find("[m] from 0 to 20"), std::string::npos);
  EXPECT_NE(with("width", "nan").find("write a number"), std::string::npos);
  EXPECT_NE(with("alternatives", "1.5").find("write a whole number"), std::string::npos);
  EXPECT_NE(with("from", "2,2").find("it may be given once"), std::string::npos);
  EXPECT_EQ(with("without", "Vehicle"), "");
  EXPECT_NE(with("near", "").find("empty"), std::string::npos);
}

TEST(QuestionsOfACampus, EveryTaskAnswersInEveryFormatWithTheSameRows) {
  const MapReader& map = CampusMap::shared().map();
  std::size_t with_reasons = 0, placeless = 0;
  for (const Task& task : allTasks()) {
    SCOPED_TRACE(task.name);
    if (task.name == "changes") continue;  // needs two visits: SiteChangesTest
    NamedValues values = requiredOf(task);
    if (task.name == "search" || task.name == "next-view") values.emplace_back("from", placeOfAStop(map));
    const TaskAnswer answer = answerOf(task, {map, true, {}}, TaskValues(task.parameters, values));
    ASSERT_EQ(answer.columns.size(), task.columns.size());
    for (std::size_t c = 0; c < task.columns.size(); ++c) EXPECT_EQ(answer.columns[c].name, task.columns[c].name);
    EXPECT_EQ(answer.has_reasons, task.has_reasons);
    std::size_t reasons = 0;
    for (const TaskRow& row : answer.rows) {
      EXPECT_EQ(row.cells.size(), task.columns.size());
      placeless += row.shape.kind == TaskShape::Kind::None ? 1 : 0;
      reasons += row.why.empty() ? 0 : row.why.size() - 1;
      with_reasons += row.why.empty() ? 0 : 1;
      EXPECT_TRUE(task.has_reasons || row.why.empty());
    }
    const TaskJson json = TaskJson::parse(answerText(map, answer, AnswerFormat::Json));
    EXPECT_EQ(json.at("rows").size(), answer.rows.size());
    const TaskJson collection = TaskJson::parse(answerText(map, answer, AnswerFormat::GeoJson, ExportFrame::Local));
    EXPECT_EQ(collection.value("notes", TaskJson::array()), json.at("notes"));
    ASSERT_EQ(collection.at("features").size(), answer.rows.size());
    for (std::size_t i = 0; i < answer.rows.size(); ++i) {
      const TaskJson &feature = collection["features"][i], &row = json["rows"][i];
      EXPECT_EQ(feature.at("geometry"), row.value("geometry", TaskJson()));
      EXPECT_EQ(feature.at("properties").value("why", TaskJson()), row.value("why", TaskJson()));
    }
    const std::string csv = answerText(map, answer, AnswerFormat::Csv);
    EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), answer.rows.size() + 1 + reasons);
    EXPECT_EQ(answerText(map, answer, AnswerFormat::Table).back(), '\n');
  }
  EXPECT_GT(with_reasons, 20U) << "objects and stops tell why";
  EXPECT_GT(placeless, 5U) << "counts of classes, ground that was not observed";
}

TEST(QuestionsOfACampus, NumbersAreWrittenAsPeopleReadThem) {
  TaskAnswer answer{{{"change", "m", ""}}, {}};
  for (const double value : {-0.00001, 0.0003, 1234567.5, -2.25}) answer.rows.push_back({{value}, {}});
  EXPECT_EQ(answerText(CampusMap::shared().map(), answer, AnswerFormat::Csv),
            "change\r\n0\r\n0.0003\r\n1234567.5\r\n-2.25\r\n");
}

TEST(QuestionsOfACampus, AnObjectsRowStandsWhereTheMapSaysItIs) {
  const MapReader& map = CampusMap::shared().map();
  const std::vector<Task> tasks = allTasks();
  const Task& task = taskNamed(tasks, "seen_from");
  const TaskAnswer answer = task.run({map, false, {}}, TaskValues(task.parameters, {}));
  ASSERT_FALSE(answer.rows.empty());
  const auto boxes = CampusMap::shared().boxesInRdf();
  for (const TaskRow& row : answer.rows) {
    const std::string iri = std::get<std::string>(row.cells[0]);
    const auto box = boxes.find(iri.substr(iri.rfind('/') + 1));
    if (box == boxes.end()) continue;
    ASSERT_EQ(row.shape.kind, TaskShape::Kind::Point);
    const Eigen::Vector2d at = row.shape.places[0];
    const double rounding_m = 0.01;
    EXPECT_LT(box->second.exteriorDistance(Eigen::Vector3d(at.x(), at.y(), box->second.center().z())), rounding_m);
  }
}

TEST(QuestionsOfACampus, KindsOfAnInventoryAreWrittenAsClasses) {
  const MapReader& map = CampusMap::shared().map();
  const std::vector<Task> tasks = allTasks();
  const Task& task = taskNamed(tasks, "inventory");
  const auto kindsOf = [&](const std::vector<std::string>& kinds) {
    NamedValues values;
    for (const std::string& kind : kinds) values.emplace_back("kind", kind);
    std::map<std::string, std::size_t> counts;
    for (const TaskRow& row : task.run({map, false, {}}, TaskValues(task.parameters, values)).rows)
      ++counts[std::get<std::string>(row.cells[0])];
    return counts;
  };
  const auto all = kindsOf({});
  ASSERT_TRUE(all.contains("Sidewalk"));
  for (const std::string& written :
       {std::string("Sidewalk"), std::string("sidewalk"), std::string("clx:Sidewalk"), vocabulary::clx("Sidewalk")})
    EXPECT_EQ(kindsOf({written}), (std::map<std::string, std::size_t>{{"Sidewalk", all.at("Sidewalk")}})) << written;
  for (const std::string& written :
       {std::string("ParkingRow"), std::string("parking row"), std::string("clx:ParkingRow")}) {
    const InventoryParams params = inventoryOfKinds(map, {written, "street lamp"});
    EXPECT_TRUE(params.with_rows) << written;
    EXPECT_FALSE(params.with_sidewalks);
    EXPECT_EQ(params.classes, std::vector<std::string>{vocabulary::clx("StreetLamp")});
  }
  EXPECT_THROW(inventoryOfKinds(map, {"Sidewalc"}), Error);
}

/// Turtle of usual places of signs: each a probability and a distance, as they are written.
std::string placesOfSigns(const std::vector<std::pair<std::string, std::string>>& places) {
  std::string text = "@prefix clx: <" + std::string(vocabulary::kClx) + "> .\n";
  for (std::size_t i = 0; i < places.size(); ++i)
    text += "clx:Place" + std::to_string(i) + " a clx:UsualPlace ; clx:usualFor clx:StreetSign ; " +
            "clx:nearClass clx:Building ; clx:probability " + places[i].first + " ; clx:within " + places[i].second +
            " .\n";
  return text;
}

TEST(QuestionsOfACampus, FaultyUsualPlacesAreRefusedByName) {
  const OntologyView ontology = ontologyViewOf(CampusMap::shared().map().quads());
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& text) -> std::string {
    writeFile(folder.path() / "places.ttl", text);
    try {
      usualPlacesOf(ontology, vocabulary::clx("StreetSign"), folder.path() / "places.ttl");
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("places.ttl"), std::string::npos) << error.what();
      return error.what();
    }
    return "read";
  };
  EXPECT_EQ(refusal(placesOfSigns({{"0.5", "3.0"}, {"5e-1", "12"}})), "read");
  for (const char* probability : {"\"NaN\"", "-0.5", "0", "1.5", "\"0.5x\""}) {
    const std::string told = refusal(placesOfSigns({{"0.1", "3"}, {probability, "3"}}));
    EXPECT_NE(told.find("Place1: clx:probability"), std::string::npos) << told;
    EXPECT_NE(told.find("above 0 and at most 1"), std::string::npos) << told;
  }
  for (const char* within : {"\"abc\"", "-5", "0", "\"INF\""}) {
    const std::string told = refusal(placesOfSigns({{"0.1", within}}));
    EXPECT_NE(told.find("Place0: clx:within"), std::string::npos) << told;
    EXPECT_NE(told.find("a distance above 0 [m]"), std::string::npos) << told;
  }
  const std::string clx =
      "@prefix clx: <" + std::string(vocabulary::kClx) + "> . clx:Here clx:usualFor clx:StreetSign ; ";
  EXPECT_NE(refusal(clx + "clx:nearClass clx:Building ; clx:within 3 .").find("no clx:probability"), std::string::npos);
  EXPECT_NE(refusal(clx + "clx:nearClass clx:Bilding ; clx:within 3 ; clx:probability 0.1 .").find("'Building'"),
            std::string::npos);
  const std::string sum = refusal(placesOfSigns({{"0.6", "3"}, {"0.7", "12"}}));
  EXPECT_NE(sum.find("sum to 1.3"), std::string::npos) << sum;
  EXPECT_NE(sum.find("correct the file"), std::string::npos) << sum;
}

TEST(SearchField, ReasonsHoldMorePlacesThanAByte) {
  constexpr std::size_t count = 300;
  const GridFrame frame{0, 0, 1, static_cast<int>(count), 1};
  std::vector<PlaceEvidence> places;
  for (std::size_t i = 0; i < count; ++i) {
    places.push_back({"Building", 0.5, 0.9 / static_cast<double>(count), LargeArray<std::uint8_t>(count, 0)});
    places.back().is_there[i] = 1;
  }
  const SearchField field = fieldOf(frame, LargeArray<float>(count, 0.0F), places);
  for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(field.reason[i], i);
}

TEST(TaskAnswer, CsvQuotesAndTablesShortenIris) {
  const MapReader& map = CampusMap::shared().map();
  const TaskAnswer answer{{{"a", "text", "x"}, {"b", "m", "x"}},
                          {{{std::string("x,\"y\""), 0.30000000000000004}},
                           {{std::string("https://w3id.org/cluxel/map/object/1"), std::monostate()}}},
                          {"a note"}};
  EXPECT_EQ(answerText(map, answer, AnswerFormat::Csv),
            "a,b\r\n\"x,\"\"y\"\"\",0.3\r\nhttps://w3id.org/cluxel/map/object/1,\r\n");
  EXPECT_EQ(answerText(map, answer, AnswerFormat::Table),
            "a             b [m]\n------------  -----\nx,\"y\"         0.3\nmap:object/1\na note\n");
}

TEST(TaskAnswer, ReasonsAreAColumnOfCsvWhereTheyWereAskedFor) {
  const MapReader& map = CampusMap::shared().map();
  TaskAnswer answer{{{"a", "text", "x"}},
                    {{{std::string("one")}, {}, {"rule r:", "yes  a, b"}}, {{std::string("two")}}}};
  answer.has_reasons = true;
  EXPECT_EQ(answerText(map, answer, AnswerFormat::Csv), "a,why\r\none,\"rule r:\nyes  a, b\"\r\ntwo,\r\n");
  answer.rows.clear();
  EXPECT_EQ(answerText(map, answer, AnswerFormat::Csv), "a,why\r\n");
  answer.has_reasons = false;
  EXPECT_EQ(answerText(map, answer, AnswerFormat::Csv), "a\r\n");
}

}  // namespace
}  // namespace cluxel::tasks
