// SPDX-License-Identifier: Apache-2.0
// `cluxel train`: trains a label model on labelled scans.
#include "app/command.hpp"
#include "app/shared_options.hpp"
#include "cluxel/error.hpp"
#include "perception/training/training_files.hpp"
#include "tasks/evaluation/model_card.hpp"
#include "tasks/evaluation/truth_source.hpp"

namespace cluxel::app {

namespace {

struct TrainOptions {
  std::vector<fs::path> inputs, helpers, helper_truths;  ///< one truth for all helpers, or one for each
  fs::path truth, output;
  std::string name, data = "Not described.";
  int group_size = 2;
  bool no_copies = false;
};

/// The command without folders, which differ between machines.
std::string commandText(const TrainOptions& options) {
  std::string command = "cluxel train";
  for (const fs::path& input : options.inputs) command += " " + input.filename().string();
  command += " --truth " + options.truth.filename().string();
  for (const fs::path& input : options.helpers) command += " --helper " + input.filename().string();
  for (const fs::path& truth : options.helper_truths) command += " --helper-truth " + truth.filename().string();
  if (options.no_copies) command += " --no-copies";
  return command + " --group-size " + std::to_string(options.group_size) + " -o " + options.output.filename().string();
}

std::vector<perception::TrainingSource> sourcesOf(const TrainOptions& options, const DataHome& home) {
  const std::vector<fs::path>& truths = options.helper_truths;
  if (!options.helpers.empty() && truths.size() != 1 && truths.size() != options.helpers.size())
    throw Error(ErrorKind::InvalidArgument,
                "--helper needs --helper-truth: one for all helpers, or one for each in their order");
  std::vector<perception::TrainingSource> sources{{options.inputs, tasks::locateTruth(options.truth, home), false}};
  for (std::size_t i = 0; i < options.helpers.size(); ++i)
    sources.push_back({{options.helpers[i]}, tasks::locateTruth(truths[truths.size() == 1 ? 0 : i], home), true});
  return sources;
}

ExitCode trainModel(const TrainOptions& options, Session& session) {
  std::error_code ignored;
  if (fs::exists(options.output, ignored) && !fs::is_directory(options.output, ignored))
    throw Error(ErrorKind::StoreUnavailable, options.output.string() + ": is a file; name a folder for the model");
  for (const char* name : {"model.json", "README.md"}) refuseToReplaceMap(options.output / name);
  const std::vector<perception::TrainingSource> sources = sourcesOf(options, session.dataHome());
  perception::CopyParams copies;
  if (options.no_copies) copies = {.sensors = {}, .drives = {}};
  const perception::PerceptionParams perception = perception::portablePerception();
  const unsigned threads = session.threadCount();
  const auto places = readPlaces(sources, perception, copies, options.group_size, threads, session.console);
  const std::string name = options.name.empty() ? options.output.filename().string() : options.name;
  perception::TrainingReport report = train(name, places, perception, {}, threads, session.console);
  report.model.provenance.insert(
      {{"command", commandText(options)}, {"data", options.data}, {"program", "cluxel " CLUXEL_VERSION}});
  fs::create_directories(options.output);
  saveModel(report.model, options.output / "model.json");
  writeOutput(options.output / "README.md", tasks::modelCard(report, {name, commandText(options), options.data}));
  if (session.json)
    printJson(Json{{"model", (options.output / "model.json").string()},
                   {"accuracy", report.left_out.accuracy()},
                   {"macro_f1", report.left_out.macroF1()},
                   {"calibration_error", report.calibration_error}});
  else
    print("On left-out groups, by point:\n" + toMarkdown(report.left_out));
  return ExitCode::Done;
}

}  // namespace

void addTrain(CLI::App& app, Session& session) {
  auto options = std::make_shared<TrainOptions>();
  CLI::App* command = app.add_subcommand("train", "train a label model on labelled scans");
  command->add_option("scans", options->inputs, "files, folders and manifests of scans")->required();
  command
      ->add_option("--truth", options->truth,
                   "a folder of truth files, or a label map: oakland, semantickitti, sydney, nuscenes, campus")
      ->required();
  command->add_option("-o,--output", options->output, "the model's folder: model.json and README.md")
      ->required()
      ->check(named());
  command->add_option("--helper", options->helpers, "scans to train on that are never used for measuring");
  command->add_option("--helper-truth", options->helper_truths,
                      "truth of the helpers, as --truth: one for all, or one for each");
  command->add_option("--name", options->name, "the model's name; default: that of the folder");
  command->add_option("--data", options->data, "description of the data, for the model's card");
  command->add_option("--group-size", options->group_size, "consecutive places left out together in cross-validation")
      ->check(wholeWithin({.min = 1, .max = 1'000'000}))
      ->capture_default_str();
  command->add_flag("--no-copies", options->no_copies, "do not train on copies that imitate other sensors");
  onRun(*command, session, [options, &session] { return trainModel(*options, session); });
}

}  // namespace cluxel::app
