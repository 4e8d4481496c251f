// SPDX-License-Identifier: Apache-2.0
// `cluxel rules try` and `cluxel rules diff`: what would change in a map under other rules. The map is not changed.
#include "app/command.hpp"
#include "app/shared_options.hpp"
#include "mapping/facts/map_oracle.hpp"
#include "rules/language/rule_loader.hpp"
#include "tasks/rule_trial/rule_difference.hpp"

namespace cluxel::app {

namespace {

struct TrialOptions {
  fs::path map, before, after, ply;
};

rules::RuleSet loadFor(const mapping::MapReader& map, const fs::path& file, const Session& session) {
  const rules::ClassCatalogue catalogue = classCatalogueOf(map.inputs().ontology);
  const fs::path found = session.dataHome().locateFile("rules", file, ".rules.yaml");
  return loadRules(std::vector{found}, catalogue, mapping::withCheckedQueries()).require();
}

ExitCode report(const TrialOptions& options, const mapping::MapReader& map, const tasks::RuleDifference& difference,
                const Session& session) {
  print(session.json ? jsonOf(difference) : textOf(difference));
  if (!options.ply.empty()) {
    std::string bytes;
    writeDifferencePly(map, difference, [&](std::string_view piece) { bytes.append(piece); });
    writeOutput(options.ply, bytes);
  }
  return difference.isEmpty() ? ExitCode::Done : ExitCode::NegativeFinding;
}

ExitCode compareRules(const TrialOptions& options, Session& session) {
  refuseToReplaceMap(options.ply);
  const mapping::MapReader map(options.map);
  const rules::RuleSet after = loadFor(map, options.after, session);
  if (options.before.empty()) return report(options, map, tasks::trialOf(map, after), session);
  return report(options, map, tasks::differenceOf(map, loadFor(map, options.before, session), after), session);
}

}  // namespace

void addRuleTrial(CLI::App& rules, Session& session) {
  auto tried = std::make_shared<TrialOptions>(), compared = std::make_shared<TrialOptions>();
  CLI::App* trying =
      rules.add_subcommand("try", "show what would change if the map had other rules; exit 1 when something would");
  trying->add_option("map", tried->map, "a finished map, which stays as it is")->required();
  trying->add_option("rules", tried->after, "the other rules")->required();
  trying->add_option("--ply", tried->ply, "write the points, coloured by kind of change, to this file")->check(named());
  CLI::App* comparing =
      rules.add_subcommand("diff", "show what differs between two sets of rules on a map; exit 1 when something does");
  comparing->add_option("map", compared->map, "a finished map, which stays as it is")->required();
  comparing->add_option("before", compared->before, "the rules before")->required();
  comparing->add_option("after", compared->after, "the rules after")->required();
  comparing->add_option("--ply", compared->ply, "write the points, coloured by kind of change, to this file")
      ->check(named());
  onRun(*trying, session, [tried, &session] { return compareRules(*tried, session); });
  onRun(*comparing, session, [compared, &session] { return compareRules(*compared, session); });
}

}  // namespace cluxel::app
