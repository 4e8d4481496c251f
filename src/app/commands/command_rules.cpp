// SPDX-License-Identifier: Apache-2.0
// `cluxel rules`: checks rule files, runs their tests, and applies rules to a map. command_rules_fit.cpp fits them.
#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include "app/command.hpp"
#include "app/commands/change_report.hpp"
#include "app/shared_options.hpp"
#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/facts/ask_replay.hpp"
#include "mapping/facts/map_oracle.hpp"
#include "mapping/facts/query_names.hpp"
#include "mapping/inference/sparql_rules.hpp"
#include "mapping/map_inputs.hpp"
#include "mapping/map_reader.hpp"
#include "perception/pipeline.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rules/language/rule_loader.hpp"
#include "rules/testing/rule_mutation.hpp"
#include "rules/testing/rule_pairs.hpp"
#include "rules/testing/rule_test.hpp"
#include "rules/testing/threshold_noise.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::app {

namespace {

struct RulesOptions {
  std::vector<fs::path> files;
  fs::path junit, map;
  std::string only;
  mapping::MapInputFiles inputs;
  bool mutate = false, update_golden = false, watch = false, pairs = false;
  double least_score = 0;
};

Json diagnosticJson(const Diagnostic& diagnostic) {
  return {{"severity", diagnostic.severity == Severity::Error ? "error" : "warning"},
          {"file", diagnostic.location.file},
          {"line", diagnostic.location.line},
          {"column", diagnostic.location.column},
          {"message", diagnostic.message},
          {"hint", diagnostic.hint}};
}

std::vector<fs::path> ruleFiles(const RulesOptions& options, const DataHome& home) {
  std::vector<fs::path> files;
  for (const fs::path& name : options.files) {
    if (fs::is_directory(name))
      for (fs::path& file : filesIn(name, {".rules.yaml", ".rq"})) files.push_back(std::move(file));
    else
      files.push_back(home.locateFile("rules", name, ".rules.yaml"));
  }
  if (files.empty() && !options.files.empty())
    throw Error(ErrorKind::InvalidArgument, options.files.front().string() + " holds no *.rules.yaml and no *.rq");
  if (files.empty()) files.push_back(home.locate("rules/outdoor.rules.yaml"));
  return files;
}

/// The shipped ontology and the files that are named.
std::vector<mapping::NamedText> ontologyFor(const RulesOptions& options, const DataHome& home) {
  std::vector<mapping::NamedText> texts = mapping::readMapInputs({}, home).ontology;
  for (const fs::path& name : options.inputs.ontology) {
    const fs::path file = home.locateFile("ontology", name, ".ttl");
    mapping::NamedText more{file.string(), readFile(file)};
    const bool is_known =
        std::any_of(texts.begin(), texts.end(), [&](const auto& text) { return text.text == more.text; });
    if (!is_known) texts.push_back(std::move(more));
  }
  checkOntology(mapping::ontologySources(texts));
  return texts;
}

rules::ClassCatalogue catalogueFor(const RulesOptions& options, const DataHome& home) {
  return classCatalogueOf(ontologyFor(options, home));
}

/// The faults of a SPARQL rule.
std::vector<Diagnostic> checkSparqlRule(const fs::path& file, const rdf::OntologyView& ontology) {
  const mapping::NamedText rule{file.string(), readFile(file)};
  try {
    mapping::checkNewSparqlRules({rule});
    return mapping::checkRuleNames(rule.name, rule.text, ontology);
  } catch (const InputError& fault) {
    return fault.diagnostics();
  }
}

/// The faults of rule files. When there are no errors, also what `options` asks for: pairs of rules that claim the same
/// thing, and thresholds that noise decides in a map.
std::vector<Diagnostic> checkTrees(const std::vector<fs::path>& files, const rdf::OntologyView& ontology,
                                   const RulesOptions& options, unsigned threads) {
  rules::RuleLoadOptions loading = mapping::withCheckedQueries(ontology);
  loading.requires_objects = true;
  rules::LoadedRules loaded = rules::loadRules(files, rules::catalogueOf(ontology), loading);
  if (options.pairs && loaded.rules)
    for (Diagnostic& pair : checkRulePairs(*loaded.rules)) loaded.diagnostics.push_back(std::move(pair));
  if (!options.map.empty() && loaded.rules) {
    const mapping::MapReader map(options.map);
    mapping::AskReplay oracle(map);
    const auto noisy = thresholdsWithinNoise(map.scene(), *loaded.rules, {.oracle = &oracle, .threads = threads});
    for (Diagnostic& warning : warningsOf(noisy)) loaded.diagnostics.push_back(std::move(warning));
  }
  return std::move(loaded.diagnostics);
}

ExitCode check(const RulesOptions& options, Session& session) {
  const DataHome home = session.dataHome();
  const auto sources = mapping::ontologySources(ontologyFor(options, home));
  const rdf::OntologyView ontology = rdf::ontologyViewOf(sources);
  std::vector<fs::path> trees;
  std::vector<Diagnostic> faults = sharedLabels(ontology);
  for (const fs::path& file : ruleFiles(options, home)) {
    if (file.extension() != ".rq") {
      trees.push_back(file);
      continue;
    }
    for (Diagnostic& fault : checkSparqlRule(file, ontology)) faults.push_back(std::move(fault));
  }
  if (!trees.empty())
    for (Diagnostic& fault : checkTrees(trees, ontology, options, session.threadCount()))
      faults.push_back(std::move(fault));
  if (session.json) {
    Json json = Json::array();
    for (const Diagnostic& fault : faults) json.push_back(diagnosticJson(fault));
    printJson(json);
  } else {
    print(faults.empty() ? "no faults" : format(faults));
  }
  return hasErrors(faults) ? ExitCode::FaultyInput : ExitCode::Done;
}

/// The scene of a map, or what the pipeline makes of a cloud with the model.
perception::Scene sceneFor(const rules::SceneRequest& request, const RulesOptions& options, Session& session) {
  if (request.kind == rules::SceneRequest::Kind::Map) return mapping::MapReader(request.path).scene();
  mapping::MapInputFiles files;
  files.model = options.inputs.model;
  const mapping::NamedText model = mapping::readMapInputs(files, session.dataHome()).model;
  const scan::ScanSet scans = scan::ScanSet::open({request.path}, {}, session.console);
  std::vector<scan::Scan> loaded;
  for (std::size_t i = 0; i < scans.size(); ++i) loaded.push_back(scans.load(i));
  return perception::sceneOf(loaded, perception::parseModel(model.text, model.name), {}, session.threadCount(),
                             perception::TileGrid(scans.mapOrigin()));
}

std::vector<fs::path> testFiles(const RulesOptions& options, const DataHome& home) {
  std::vector<fs::path> files;
  for (const fs::path& file : options.files) files.push_back(home.locateFile("rules", file, ".rules-test.yaml"));
  if (files.empty()) files.push_back(home.locate("rules/outdoor.rules-test.yaml"));
  return files;
}

/// `--junit` takes the next word as its value. That is a test file when the report's name was forgotten.
void refuseToReplaceTests(const fs::path& junit) {
  if (junit.extension() == ".yaml" || junit.extension() == ".yml")
    throw Error(
        ErrorKind::InvalidArgument,
        "--junit " + junit.string() + ": the report would replace what looks like rules or their tests; name it *.xml");
}

rules::RuleTestOptions testOptions(const RulesOptions& options, Session& session) {
  rules::RuleTestOptions test_options;
  test_options.scenes = [&](const rules::SceneRequest& request) { return sceneFor(request, options, session); };
  if (!options.only.empty()) test_options.only = options.only;
  return test_options;
}

ExitCode mutate(const RulesOptions& options, Session& session) {
  const DataHome home = session.dataHome();
  const rules::ClassCatalogue catalogue = catalogueFor(options, home);
  const rules::RuleTestOptions test_options = testOptions(options, session);
  Json json = Json::array();
  bool good = true;
  const std::vector<fs::path> files = testFiles(options, home);
  for (const fs::path& file : files) {
    const rules::RuleMutationReport report = mutateRules(file, catalogue, test_options, session.threadCount());
    if (session.json)
      json.push_back(Json::parse(jsonOf(report)));
    else
      print(textOf(report));
    good = good && report.score() >= options.least_score;
  }
  if (session.json) printJson(files.size() == 1 ? json.front() : json);
  return good ? ExitCode::Done : ExitCode::NegativeFinding;
}

ExitCode updateGoldenFiles(const RulesOptions& options, Session& session) {
  const DataHome home = session.dataHome();
  const rules::ClassCatalogue catalogue = catalogueFor(options, home);
  std::size_t count = 0;
  for (const fs::path& file : testFiles(options, home))
    for (const fs::path& written : updateGolden(file, catalogue, testOptions(options, session))) {
      print("wrote " + written.string());
      ++count;
    }
  if (count == 0) throw Error(ErrorKind::InvalidArgument, "--update-golden: no test has a golden file");
  return ExitCode::Done;
}

ExitCode runTests(const RulesOptions& options, Session& session) {
  refuseToReplaceTests(options.junit);
  refuseToReplaceMap(options.junit);
  const DataHome home = session.dataHome();
  const rules::ClassCatalogue catalogue = catalogueFor(options, home);
  const rules::RuleTestOptions test_options = testOptions(options, session);
  bool passed = true;
  std::size_t run = 0;
  Json json = Json::array();
  std::string junit = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  const std::vector<fs::path> files = testFiles(options, home);
  for (const fs::path& file : files) {
    const rules::RuleTestReport report = runRuleTests(file, catalogue, test_options);
    if (session.json)
      json.push_back(Json::parse(jsonOf(report)));
    else
      print(textOf(report));
    junit += junitOf(report, file.filename().string());
    passed = passed && report.passed();
    run += report.results.size();
  }
  if (session.json) printJson(files.size() == 1 ? json.front() : json);
  if (!options.junit.empty()) writeOutput(options.junit, junit + "</testsuites>\n");
  if (run == 0)
    throw Error(ErrorKind::InvalidArgument, options.only.empty() ? "the test files contain no test"
                                                                 : "no test's name contains '" + options.only + "'");
  return passed ? ExitCode::Done : ExitCode::NegativeFinding;
}

bool isRuleFile(const fs::path& file) {
  return file.extension() == ".yaml" || file.extension() == ".yml";
}

/// When the files that a run of `tests` depends on were last written.
std::map<fs::path, fs::file_time_type> timesOf(const std::vector<fs::path>& tests, const RulesOptions& options,
                                               const Session& session) {
  std::vector<fs::path> files = tests;
  std::error_code ignored;
  try {
    const rules::ClassCatalogue catalogue = catalogueFor(options, session.dataHome());
    for (const fs::path& file : tests)
      for (const fs::path& more : filesOfRuleTests(file, catalogue)) files.push_back(more);
  } catch (const Error&) {
    // The list of files cannot be read from a faulty test file. All rule files of its folder are watched instead.
    for (const fs::path& file : tests)
      for (const auto& entry : fs::directory_iterator(fs::absolute(file).parent_path(), ignored))
        if (isRuleFile(entry.path())) files.push_back(entry.path());
  }
  std::map<fs::path, fs::file_time_type> times;
  for (const fs::path& file : files) times[file] = fs::last_write_time(file, ignored);
  return times;
}

/// Runs the tests again whenever one of their files changes, until the program is stopped. Editors replace a file by
/// renaming another one over it, so that it may be absent for a moment.
[[noreturn]] void watch(const RulesOptions& options, Session& session) {
  const std::vector<fs::path> tests = testFiles(options, session.dataHome());
  while (true) {
    const auto times = timesOf(tests, options, session);
    try {
      options.mutate ? mutate(options, session) : runTests(options, session);
    } catch (const Error& fault) {
      print(fault.what());
    }
    std::fflush(stdout);
    while (timesOf(tests, options, session) == times) std::this_thread::sleep_for(std::chrono::milliseconds(300));
  }
}

ExitCode test(const RulesOptions& options, Session& session) {
  if (options.watch) watch(options, session);
  if (options.update_golden) return updateGoldenFiles(options, session);
  return options.mutate ? mutate(options, session) : runTests(options, session);
}

struct ApplyOptions {
  fs::path map;
  mapping::MapInputFiles files;
  mapping::ChangeParams change;
};

/// The map's inputs, with the named ones replaced.
mapping::MapInputs inputsWith(const mapping::MapInputFiles& named, mapping::MapInputs inputs, const Session& session) {
  if (named.rules.empty() && named.sparql_rules.empty() && named.ontology.empty() && named.model.empty())
    throw Error(ErrorKind::InvalidArgument,
                "name what to apply: --rules, --sparql-rules, --ontology or --model; the rest stays");
  return withNamedFiles(std::move(inputs), named, session.dataHome());
}

ExitCode apply(const ApplyOptions& options, Session& session) {
  mapping::ChangeParams params = options.change;
  params.threads = session.threadCount();
  const auto change = [&](mapping::MapInputs inputs) { return inputsWith(options.files, std::move(inputs), session); };
  printChange(options.map, applyInputs(options.map, change, params, session.console), params, session);
  return ExitCode::Done;
}

void addApply(CLI::App& rules, Session& session) {
  auto options = std::make_shared<ApplyOptions>();
  CLI::App* applying =
      rules.add_subcommand("apply", "give a map other rules, another ontology or model, and recompute it");
  applying->add_option("map", options->map, "a finished map")->required();
  applying->add_option("--rules", options->files.rules, "rule files instead of the map's");
  applying->add_option("--sparql-rules", options->files.sparql_rules, "CONSTRUCT rules instead of the map's");
  applying->add_option("--ontology", options->files.ontology, "ontology files instead of the map's");
  applying->add_option("--model", options->files.model,
                       "a trained model instead of the map's: a name in models/, a folder or a file");
  addChangeOptions(*applying, options->change, false);
  onRun(*applying, session, [options, &session] { return apply(*options, session); });
}

}  // namespace

void addRules(CLI::App& app, Session& session) {
  auto options = std::make_shared<RulesOptions>();
  CLI::App* rules = app.add_subcommand("rules", "check, test, try, compare, fit, teach, describe and apply rules");
  rules->require_subcommand(1);
  CLI::App* checking = rules->add_subcommand("check", "report every fault with file, line and column");
  checking->add_option("files", options->files,
                       "rule files, SPARQL rules (*.rq), or folders of both; default: rules/outdoor.rules.yaml");
  checking->add_option("--ontology", options->inputs.ontology, "ontology files beside ontology/*.ttl");
  checking->add_flag("--pairs", options->pairs,
                     "find pairs of rules that can accept the same thing with equal evidence, and show an example");
  checking->add_option("--map", options->map,
                       "find thresholds that measurement noise decides for a tenth or more of this map's things");
  CLI::App* testing = rules->add_subcommand("test", "run rule tests; exit 1 when one fails");
  testing->add_option("files", options->files, "test files; default: rules/outdoor.rules-test.yaml");
  testing->add_option("--junit", options->junit, "write a JUnit report to this file");
  testing->add_option("--only", options->only, "only tests whose name contains this text");
  testing->add_flag("--mutate", options->mutate,
                    "mutation test: put small errors into the rules, and count those that the tests find");
  testing->add_option("--least-score", options->least_score, "with --mutate: exit 1 below this share")->check(share());
  testing->add_flag("--update-golden", options->update_golden, "write the present results into the golden files");
  testing->add_flag("--watch", options->watch, "run again whenever a file of the tests changes, until stopped");
  testing->add_option("--model", options->inputs.model, "the model for tests on clouds");
  testing->add_option("--ontology", options->inputs.ontology, "ontology files beside ontology/*.ttl");
  onRun(*testing, session, [options, &session] { return test(*options, session); });
  onRun(*checking, session, [options, &session] { return check(*options, session); });
  addApply(*rules, session);
  addRuleTrial(*rules, session);
  addRuleFit(*rules, session);
  addRuleTeaching(*rules, session);
  addRuleReference(*rules, session);
}

}  // namespace cluxel::app
