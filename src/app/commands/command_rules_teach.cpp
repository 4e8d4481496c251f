// SPDX-License-Identifier: Apache-2.0
// `cluxel rules teach`: writes an exception for one object of a map, and a rule test of it.
#include "app/command.hpp"
#include "app/shared_options.hpp"
#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/map_reader.hpp"
#include "rules/testing/rule_test.hpp"
#include "tasks/rule_teaching/lesson.hpp"

namespace cluxel::app {

namespace {

struct TeachOptions {
  fs::path map, out = "taught.rules.yaml";
  tasks::LessonRequest lesson;
};

constexpr std::string_view kRuleEnding = ".rules.yaml";

fs::path testFileOf(const fs::path& rules) {
  const std::string name = rules.filename().string();
  return rules.parent_path() / (name.substr(0, name.size() - kRuleEnding.size()) + ".rules-test.yaml");
}

/// The files of the map that the new one includes, below the folder of the new one.
std::vector<std::pair<fs::path, std::string>> includedFiles(const mapping::MapReader& map, const fs::path& folder) {
  std::vector<std::pair<fs::path, std::string>> files;
  const mapping::MapInputs inputs = map.inputs();
  for (const mapping::NamedText& own : inputs.rules) {
    const fs::path base = fs::path(inputs.rules.front().name).parent_path();
    files.emplace_back(folder / mapping::nameWithin(base, own.name), own.text);
  }
  return files;
}

void refuseToReplace(const TeachOptions& options, const mapping::MapReader& map) {
  if (!options.out.filename().string().ends_with(kRuleEnding))
    throw Error(ErrorKind::InvalidArgument,
                options.out.string() + ": name the new rule file *" + std::string(kRuleEnding));
  for (const fs::path& file : {options.out, testFileOf(options.out)})
    if (fs::exists(file))
      throw Error(ErrorKind::StoreUnavailable,
                  file.string() + " exists, and lessons are not added to a file: name another, or apply it first");
  for (const auto& [file, text] : includedFiles(map, options.out.parent_path()))
    if (fs::exists(file) && readFile(file) != text)
      throw Error(ErrorKind::StoreUnavailable,
                  file.string() +
                      " differs from the map's own rules, which the new file includes: name "
                      "a file in another folder");
}

ExitCode teach(TeachOptions& options, Session& session) {
  const mapping::MapReader map(options.map);
  refuseToReplace(options, map);
  options.lesson.rule_file = options.out.filename().string();
  const tasks::Lesson lesson = tasks::teach(map, options.lesson);
  for (const auto& [file, text] : includedFiles(map, options.out.parent_path()))
    if (!fs::exists(file)) writeOutput(file, text);
  writeOutput(options.out, lesson.rules);
  writeOutput(testFileOf(options.out), lesson.test);
  print(session.json ? jsonOf(lesson) : textOf(lesson));
  const rules::RuleTestReport report = runRuleTests(testFileOf(options.out), classCatalogueOf(map.inputs().ontology));
  if (!report.passed()) session.console.note("the test of the case fails, because its neighbours are not in it");
  if (!session.json) print("wrote " + options.out.string() + " and " + testFileOf(options.out).string());
  return lesson.changesNothingElse() ? ExitCode::Done : ExitCode::NegativeFinding;
}

}  // namespace

void addRuleTeaching(CLI::App& rules, Session& session) {
  auto options = std::make_shared<TeachOptions>();
  CLI::App* teaching = rules.add_subcommand(
      "teach", "write the smallest exception that gives an object another class; exit 1 when other things change too");
  teaching->add_option("map", options->map, "a finished map, which stays as it is")->required();
  teaching->add_option("object", options->lesson.object, "the object: its number, or the first digits of its hash")
      ->required();
  teaching->add_option("--is", options->lesson.class_name, "its true class")->required()->check(named());
  teaching->add_option("--confirmed", options->lesson.confirmed,
                       "objects that are right and must not change; default: all others of the map");
  teaching->add_option("-o,--out", options->out, "the new rule file; its test gets the ending .rules-test.yaml")
      ->check(named())
      ->capture_default_str();
  onRun(*teaching, session, [options, &session] { return teach(*options, session); });
}

}  // namespace cluxel::app
