// SPDX-License-Identifier: Apache-2.0
// `cluxel train`: a label model from labelled scans.
#include "app/command.hpp"
#include "cluxel/base/diagnostic.hpp"
#include "cluxel/base/file_bytes.hpp"
#include "cluxel/tasks/model_training.hpp"

namespace cluxel::app {

namespace {

struct TrainOptions {
  std::vector<fs::path> inputs;
  fs::path poses, truth, output;
  std::string data = "Not described.";
  ModelTrainingParams params;
};

ExitCode train(TrainOptions& options, Session& session) {
  if (options.params.name.empty()) options.params.name = options.output.filename().string();
  const ScanSet scans = ScanSet::open(options.inputs, {options.poses}, session.console);
  const TruthSource truth = TruthSource::open(options.truth, session.dataHome());
  const unsigned threads = session.threadCount();
  const auto places = trainingPlaces(scans, truth, options.params, threads, session.console);
  const TrainingReport report = cluxel::train(options.params.name, places, options.params.perception,
                                              options.params.train, threads, session.console);
  fs::create_directories(options.output);
  saveModel(report.model, options.output / "model.json");
  std::string command = "cluxel train";
  for (const fs::path& input : options.inputs) command += " " + input.filename().string();
  command += " --truth " + options.truth.filename().string() + " -o " + options.output.filename().string();
  writeFile(options.output / "README.md", modelCard(report, options.params, command, options.data));
  if (session.json)
    printJson(Json{{"model", (options.output / "model.json").string()}, {"accuracy", report.left_out.accuracy()},
                   {"macro_f1", report.left_out.macroF1()}, {"calibration_error", report.calibration_error}});
  else
    print("On left-out groups, by point:\n" + toMarkdown(report.left_out));
  return ExitCode::Done;
}

}  // namespace

void addTrain(CLI::App& app, Session& session) {
  auto options = std::make_shared<TrainOptions>();
  CLI::App* command = app.add_subcommand("train", "make a label model from labelled scans");
  command->add_option("scans", options->inputs, "files, folders and manifests of scans")->required();
  command->add_option("--truth", options->truth, "a folder of truth files, or a label map: oakland, semantickitti, campus")
      ->required();
  command->add_option("-o,--output", options->output, "the model's folder: model.json and README.md")->required();
  command->add_option("--poses", options->poses, "poses of the scans");
  command->add_option("--name", options->params.name, "the model's name; else the folder's");
  command->add_option("--data", options->data, "what the data are, for the model's card");
  command->add_option("--scans-per-group", options->params.scans_per_group, "consecutive scans left out together")
      ->capture_default_str();
  command->add_flag("--together", options->params.together, "scans of a group overlap: perceive them together");
  onRun(*command, session, [options, &session] { return train(*options, session); });
}

}  // namespace cluxel::app
