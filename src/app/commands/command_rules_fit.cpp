// SPDX-License-Identifier: Apache-2.0
// `cluxel rules fit`: learns the numbers of evidence from maps with truth and writes them into the rule file.
#include <algorithm>

#include "app/command.hpp"
#include "app/shared_options.hpp"
#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/facts/map_oracle.hpp"
#include "mapping/map_inputs.hpp"
#include "mapping/map_reader.hpp"
#include "rules/language/rule_loader.hpp"
#include "tasks/evaluation/shared_scans.hpp"
#include "tasks/evaluation/truth_source.hpp"
#include "tasks/rule_fitting/candidate_examples.hpp"
#include "tasks/rule_fitting/evidence_fit.hpp"
#include "tasks/rule_fitting/rule_text_edit.hpp"

namespace cluxel::app {

namespace {

struct FitOptions {
  std::vector<fs::path> maps;
  fs::path truth, rules, out;
  std::vector<std::string> also, keep;
  mapping::MapInputFiles inputs;
  tasks::EvidenceFitParams params;
};

/// Maps that share a truth.
struct TruthMaps {
  fs::path truth;
  std::vector<fs::path> maps;
};

std::vector<fs::path> mapsIn(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return {path};
  const std::vector<fs::path> maps = filesIn(path, {".clx"});
  if (maps.empty()) throw Error(ErrorKind::InvalidArgument, path.string() + " holds no maps (*.clx)");
  return maps;
}

std::vector<TruthMaps> setsOf(const FitOptions& options) {
  std::vector<TruthMaps> sets{{options.truth, {}}};
  for (const fs::path& map : options.maps)
    for (const fs::path& file : mapsIn(map)) sets.front().maps.push_back(file);
  for (const std::string& text : options.also) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
      throw Error(ErrorKind::InvalidArgument, "--also takes TRUTH=MAPS, not '" + text + "'");
    sets.push_back({text.substr(0, equals), mapsIn(text.substr(equals + 1))});
  }
  return sets;
}

std::vector<tasks::CandidateExample> collect(const FitOptions& options, const rules::RuleSet& rules, Session& session) {
  std::vector<tasks::CandidateExample> examples;
  tasks::SharedScans scans;
  for (const TruthMaps& set : setsOf(options)) {
    const auto truth = tasks::TruthSource::open(set.truth, session.dataHome());
    for (const fs::path& file : set.maps) {
      const mapping::MapReader map(file);
      const auto shared = scans.add(file.string(), map.clouds());
      auto more = candidateExamples(map, rules, truth, false);
      if (shared) {
        const std::size_t left_out =
            std::erase_if(more, [&](const auto& example) { return scans.isOfEarlierMap(example.place); });
        session.console.note(*shared + ": " + std::to_string(left_out) +
                             " candidates of these are left out, they count already");
      }
      std::move(more.begin(), more.end(), std::back_inserter(examples));
    }
  }
  return examples;
}

std::string shown(const tasks::FittedNumber& number) {
  const auto text = [&](double value) {
    tasks::FittedNumber other = number;
    other.after = value;
    return writtenNumber(other);
  };
  return toString(number.at) + ": " + number.what + ": " + text(number.before) + " -> " + writtenNumber(number) +
         "   (" + text(number.low) + " to " + text(number.high) + ")";
}

void printFit(const std::vector<tasks::FittedRule>& fitted, Session& session) {
  Json json = Json::array();
  for (const tasks::FittedRule& rule : fitted) {
    Json entry{{"rule", rule.rule_id}, {"right", rule.right}, {"wrong", rule.wrong}, {"changes", Json::array()}};
    if (!rule.refusal.empty()) entry["refusal"] = rule.refusal;
    if (rule.kept > 0) entry["kept"] = rule.kept;
    if (rule.loss_after > 0) entry["loss_before"] = rule.loss_before, entry["loss_after"] = rule.loss_after;
    for (const tasks::FittedNumber& number : rule.changes)
      entry["changes"].push_back({{"line", number.at.line},
                                  {"what", number.what},
                                  {"before", number.before},
                                  {"after", number.after},
                                  {"low", number.low},
                                  {"high", number.high}});
    json.push_back(std::move(entry));
    if (session.json) continue;
    std::string text = rule.rule_id + ": " + std::to_string(rule.right) + " right, " + std::to_string(rule.wrong) +
                       " wrong candidates; ";
    char losses[96];
    std::snprintf(losses, sizeof losses, "log loss on places left out %.3f -> %.3f", rule.loss_before, rule.loss_after);
    text += rule.is_fitted ? std::string(losses) : "unchanged";
    if (!rule.refusal.empty()) text += ": " + rule.refusal;
    if (rule.kept > 0)
      text += "; " + std::to_string(rule.kept) +
              " numbers stay, because other rules use their definition too: write them out to fit them";
    for (const tasks::FittedNumber& number : rule.changes) text += "\n  " + shown(number);
    print(text);
  }
  if (session.json) printJson(json);
}

ExitCode fit(const FitOptions& options, Session& session) {
  const DataHome home = session.dataHome();
  const fs::path file = options.rules.empty() ? home.locate("rules/outdoor.rules.yaml")
                                              : home.locateFile("rules", options.rules, ".rules.yaml");
  const rules::ClassCatalogue catalogue = classCatalogueOf(readMapInputs(options.inputs, home).ontology);
  const rules::RuleSet rules = loadRules(std::vector{file}, catalogue, mapping::withCheckedQueries()).require();
  const auto examples = collect(options, rules, session);
  if (examples.empty())
    throw Error(ErrorKind::InvalidArgument, "no rule proposes anything that has truth in these maps");
  for (const std::string& id : options.keep)
    if (rules.find(id) == nullptr) throw Error(ErrorKind::InvalidArgument, "--keep " + id + ": no rule has this id");
  auto fitted = fitEvidence(rules, examples, options.params);
  std::erase_if(fitted, [&](const tasks::FittedRule& rule) {
    return std::find(options.keep.begin(), options.keep.end(), rule.rule_id) != options.keep.end();
  });
  printFit(fitted, session);
  if (options.out.empty()) return ExitCode::Done;
  std::vector<tasks::FittedNumber> changes;
  for (const tasks::FittedRule& rule : fitted) changes.insert(changes.end(), rule.changes.begin(), rule.changes.end());
  const rules::RuleSource& main = rules.sources.front();
  for (const tasks::FittedNumber& change : changes)
    if (change.at.file != main.name)
      session.console.note(toString(change.at) + ": stands in an included file, which is not written");
  writeOutput(options.out, withNumbers(main.text, main.name, changes));
  return ExitCode::Done;
}

}  // namespace

void addRuleFit(CLI::App& rules, Session& session) {
  auto options = std::make_shared<FitOptions>();
  CLI::App* fitting = rules.add_subcommand("fit", "fit the numbers of the rules' evidence to maps with truth");
  fitting->add_option("maps", options->maps, "finished maps, or folders of them")->required();
  fitting->add_option("--truth", options->truth, "a label map in labels/ or a folder of truth files")->required();
  fitting->add_option("--also", options->also, "more maps with another truth: TRUTH=MAP or TRUTH=FOLDER");
  fitting->add_option("--keep", options->keep, "the id of a rule that stays as it is");
  fitting->add_option("--rules", options->rules, "the rule file; default: rules/outdoor.rules.yaml");
  fitting->add_option("-o,--out", options->out, "write the rule file with the new numbers here");
  fitting
      ->add_option("--min-examples", options->params.min_examples,
                   "smallest number of right and of wrong candidates for fitting a rule (default 10)")
      ->check(wholeAbove0());
  fitting
      ->add_option("--interval", options->params.interval,
                   "change a number when this share of the resamples excludes the old one (default 0.8)")
      ->check(share());
  fitting
      ->add_option("--ridge", options->params.ridge,
                   "strength with which the ridge pulls log-odds towards 0 (default 4)")
      ->check(above0());
  fitting->add_option("--ontology", options->inputs.ontology, "ontology files instead of ontology/*.ttl");
  onRun(*fitting, session, [options, &session] { return fit(*options, session); });
}

}  // namespace cluxel::app
