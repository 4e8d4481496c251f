// SPDX-License-Identifier: Apache-2.0
// `cluxel evaluate`: the accuracy of a map; minimum values set the exit code.
#include <charconv>
#include <set>

#include "app/command.hpp"
#include "app/map_condition.hpp"
#include "app/shared_options.hpp"
#include "cluxel/error.hpp"
#include "tasks/evaluation/evaluation.hpp"
#include "tasks/evaluation/shared_scans.hpp"
#include "tasks/named_class.hpp"
#include "tasks/plots/evaluation_plots.hpp"

namespace cluxel::app {

namespace {

struct EvaluateOptions {
  std::vector<fs::path> maps;
  fs::path truth, html;
  double min_oa = 0, min_macro_f1 = 0;
  std::vector<std::string> min_recall;  ///< CLASS=share
  bool allow_unfinished = false;
};

std::optional<double> recallOf(const tasks::MapEvaluation& evaluation, const std::string& name) {
  for (const tasks::ConfusionMatrix* matrix : {&evaluation.objects, &evaluation.primitives})
    for (std::size_t i = 0; i < matrix->names.size(); ++i)
      if (matrix->names[i] == name) return matrix->recall(i);
  return std::nullopt;
}

/// Recall by point of an object class or a primitive. A truth may have classes that no ontology knows: its own names go
/// before what the map calls so.
double recallOf(const tasks::MapEvaluation& evaluation, const std::string& written, const fs::path& file) {
  if (const auto recall = recallOf(evaluation, written)) return *recall;
  const mapping::MapReader map(file);
  std::string name = written;
  try {
    name = namesOf(classCatalogueOf(map.inputs().ontology)).nameOf(tasks::classNamed(map, written));
  } catch (const Error& fault) {
    throw Error(ErrorKind::InvalidArgument, std::string("--min-recall: ") + fault.what());
  }
  if (const auto recall = recallOf(evaluation, name)) return *recall;
  throw Error(ErrorKind::InvalidArgument, "--min-recall: the truth has no class '" + name + "'");
}

bool isAbove(const char* what, double value, double bar) {
  if (value >= bar) return true;
  std::fprintf(stderr, "cluxel: %s is %.4f, below %.4f\n", what, value, bar);
  return false;
}

/// "Tree=0.7" as name and share.
std::pair<std::string, double> barOf(const std::string& text) {
  const std::size_t cut = std::min(text.find('='), text.size());
  double share = 0;
  const char* first = text.data() + std::min(cut + 1, text.size());
  const auto [end, fault] = std::from_chars(first, text.data() + text.size(), share);
  const bool is_share = share >= 0 && share <= 1;
  if (fault != std::errc() || end != text.data() + text.size() || cut == 0 || !is_share)
    throw Error(ErrorKind::InvalidArgument,
                "--min-recall: write CLASS=SHARE, for example Tree=0.7, not '" + text + "'");
  return {text.substr(0, cut), share};
}

bool meetsBars(const tasks::MapEvaluation& evaluation, const EvaluateOptions& options) {
  bool meets = isAbove("overall accuracy of objects by point", evaluation.objects.overallAccuracy(), options.min_oa);
  meets &= isAbove("macro F1 of objects by point", evaluation.objects.macroF1(), options.min_macro_f1);
  for (const std::string& bar : options.min_recall) {
    const auto [name, share] = barOf(bar);
    meets &= isAbove(("recall of " + name).c_str(), recallOf(evaluation, name, options.maps.front()), share);
  }
  return meets;
}

tasks::MapEvaluation evaluateAll(const EvaluateOptions& options, Session& session) {
  const auto truth = tasks::TruthSource::open(options.truth, session.dataHome());
  std::optional<tasks::MapEvaluation> sum;
  std::set<std::string> doubts;  // those of several maps are mostly the same
  tasks::SharedScans scans;
  for (const fs::path& file : options.maps) {
    const mapping::MapReader map(file);
    noteUnfinished(file, map.isFinished(), options.allow_unfinished, session);
    if (const auto shared = scans.add(file.string(), map.clouds()))
      session.console.note(*shared +
                           ": they count once for each map, so the intervals are narrower than they should be");
    for (const std::string& doubt : truth.doubtfulClasses(classCatalogueOf(map.inputs().ontology)))
      if (doubts.insert(doubt).second) session.console.note(doubt);
    tasks::MapEvaluation one = evaluateMap(map, truth);
    if (sum)
      sum->add(one);
    else
      sum = std::move(one);
  }
  return *sum;
}

void writeEvaluationFigures(const tasks::MapEvaluation& evaluation, const EvaluateOptions& options) {
  std::vector<std::string> names;
  for (const fs::path& map : options.maps) names.push_back(map.filename().string());
  refuseToReplaceMap(options.html);
  writeOutput(options.html, tasks::plotPage(tasks::evaluationPlots(evaluation, names)));
}

}  // namespace

void addEvaluate(CLI::App& app, Session& session) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command = app.add_subcommand("evaluate", "compare maps with ground truth");
  command->add_option("maps", options->maps, "maps; their counts are added")->required();
  command
      ->add_option("--truth", options->truth,
                   "a folder of truth files, or a label map: oakland, semantickitti, sydney, nuscenes, campus")
      ->required();
  command->add_option("--min-oa", options->min_oa, "exit 1 when the overall accuracy of objects by point is below this")
      ->check(share());
  command
      ->add_option("--min-macro-f1", options->min_macro_f1,
                   "exit 1 when the macro F1 of objects by point is below this")
      ->check(share());
  command->add_option("--min-recall", options->min_recall,
                      "CLASS=SHARE: exit 1 when the recall of the class by point is below this");
  addHtmlFile(*command, options->html);
  addAllowUnfinished(*command, options->allow_unfinished);
  onRun(*command, session, [options, &session] {
    for (const std::string& bar : options->min_recall) barOf(bar);
    const tasks::MapEvaluation evaluation = evaluateAll(*options, session);
    const bool meets = meetsBars(evaluation, *options);  // before printing: an unknown class is a usage error
    if (!options->html.empty()) writeEvaluationFigures(evaluation, *options);
    print(session.json ? toJson(evaluation) : toText(evaluation));
    return meets ? ExitCode::Done : ExitCode::NegativeFinding;
  });
}

}  // namespace cluxel::app
