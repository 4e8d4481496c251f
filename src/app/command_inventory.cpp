// SPDX-License-Identifier: Apache-2.0
// `cluxel inventory`: what a town keeps lists of, alone or beside its register.
#include "app/answer_output.hpp"
#include "app/command.hpp"
#include "app/unfinished_note.hpp"
#include "cluxel/error.hpp"
#include "tasks/ask/inventory_task.hpp"

namespace cluxel::app {

namespace {

struct InventoryArguments {
  fs::path map, streets, register_file;
  std::vector<std::string> kinds;
  tasks::RegisterParams comparison;
  AnswerOutput output;
  bool allow_unfinished = false;
};

tasks::InventoryParams paramsOf(const InventoryArguments& arguments) {
  tasks::InventoryParams params;
  if (arguments.kinds.empty()) return params;
  params.classes.clear();
  params.with_rows = false;
  for (const std::string& kind : arguments.kinds) {
    if (kind == "ParkingRow")
      params.with_rows = true;
    else
      params.classes.push_back(kind);
  }
  return params;
}

ExitCode inventory(const InventoryArguments& arguments, Session& session) {
  const mapping::MapReader map(arguments.map);
  noteUnfinished(arguments.map, map.isFinished(), arguments.allow_unfinished, session);
  const mapping::MapInputs inputs = map.inputs();
  if (!arguments.register_file.empty())
    return printAnswer(map,
                       registerAnswer(map, paramsOf(arguments), tasks::readRegister(arguments.register_file, inputs),
                                      arguments.comparison),
                       arguments.output, session);
  const std::vector<tasks::Street> streets =
      arguments.streets.empty() ? std::vector<tasks::Street>() : tasks::readStreets(arguments.streets, inputs);
  return printAnswer(map, inventoryAnswer(map, paramsOf(arguments), streets), arguments.output, session);
}

}  // namespace

void addInventory(CLI::App& app, Session& session) {
  auto options = std::make_shared<InventoryArguments>();
  CLI::App* command = app.add_subcommand("inventory", "list signs, lamps, trees and parked vehicles");
  command->add_option("map", options->map, "a map")->required();
  command->add_option("--kind", options->kinds, "a class, or ParkingRow; else all that a town lists");
  command->add_option("--streets", options->streets, "GeoJSON lines with names: each thing gets its nearest street")
      ->check(CLI::ExistingFile);
  command->add_option("--register", options->register_file, "CSV or GeoJSON of what should be there: compare with it")
      ->check(CLI::ExistingFile);
  command->add_option("--within", options->comparison.within_m, "an entry and its object are so near [m, 3]")
      ->check(above0());
  command->add_option("--view", options->comparison.view_m, "a place is observed from within this distance [m, 25]")
      ->check(above0());
  addAnswerOutput(*command, options->output);
  addAllowUnfinished(*command, options->allow_unfinished);
  onRun(*command, session, [options, &session] { return inventory(*options, session); });
}

}  // namespace cluxel::app
