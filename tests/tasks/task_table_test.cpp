// SPDX-License-Identifier: Apache-2.0
// The table of tasks: every task answers with its columns, parameters are checked, answers have the same rows in all
// formats.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tasks/ask/task_table.hpp"
#include "tasks/campus_map_fixture.hpp"

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
  std::size_t with_reasons = 0;
  for (const Task& task : allTasks()) {
    SCOPED_TRACE(task.name);
    if (task.name == "changes") continue;  // needs two visits: SiteChangesTest
    TaskAnswer answer = task.run({map, true, {}}, TaskValues(task.parameters, requiredOf(task)));
    if (answer.columns.empty()) answer.columns = task.columns;
    ASSERT_EQ(answer.columns.size(), task.columns.size());
    for (std::size_t c = 0; c < task.columns.size(); ++c) EXPECT_EQ(answer.columns[c].name, task.columns[c].name);
    std::size_t placed = 0;
    for (const TaskRow& row : answer.rows) {
      EXPECT_EQ(row.cells.size(), task.columns.size());
      placed += row.shape.kind != TaskShape::Kind::None ? 1 : 0;
      with_reasons += row.why.empty() ? 0 : 1;
      EXPECT_TRUE(task.has_reasons || row.why.empty());
    }
    const TaskJson json = TaskJson::parse(answerText(map, answer, AnswerFormat::Json));
    EXPECT_EQ(json.at("rows").size(), answer.rows.size());
    const TaskJson features = TaskJson::parse(answerText(map, answer, AnswerFormat::GeoJson, ExportFrame::Local));
    EXPECT_EQ(features.at("features").size(), placed);
    const std::string csv = answerText(map, answer, AnswerFormat::Csv);
    EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), answer.rows.size() + 1);
    EXPECT_EQ(answerText(map, answer, AnswerFormat::Table).back(), '\n');
  }
  EXPECT_GT(with_reasons, 20U) << "objects and stops tell why";
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

}  // namespace
}  // namespace cluxel::tasks
