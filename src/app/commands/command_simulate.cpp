// SPDX-License-Identifier: Apache-2.0
// `cluxel simulate`: scans of a generated campus with truth and poses.
#include <map>

#include "app/command.hpp"
#include "scan/truth/truth.hpp"
#include "simulation/laser/campus_writer.hpp"

namespace cluxel::app {

namespace {

struct SimulateOptions {
  fs::path folder;
  simulation::CampusParams params;
};

ExitCode simulate(const SimulateOptions& options, Session& session) {
  check(options.params);
  const simulation::Campus campus = buildCampus(options.params);
  const simulation::CampusSummary summary = writeCampus(campus, options.folder, session.threadCount(), session.console);
  Json classes = Json::object();
  for (std::size_t i = 0; i < summary.objects_of_class.size(); ++i)
    classes[scan::truthClassNames()[i]] = summary.objects_of_class[i];
  if (session.json) {
    printJson(Json{{"folder", options.folder.string()},
                   {"seed", options.params.seed},
                   {"scans", summary.scans},
                   {"points", summary.points},
                   {"objects", summary.objects},
                   {"objects_by_class", classes}});
    return ExitCode::Done;
  }
  std::printf("%s: %zu scans, %zu points, %zu objects (generated, seed %llu)\n", options.folder.c_str(), summary.scans,
              summary.points, summary.objects, static_cast<unsigned long long>(options.params.seed));
  return ExitCode::Done;
}

}  // namespace

void addSimulate(CLI::App& app, Session& session) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = app.add_subcommand("simulate", "write scans of a generated campus with truth and poses");
  command->add_option("folder", options->folder, "new or empty folder for the scans")->required()->check(named());
  command->add_option("--seed", options->params.seed, "seed of the generator: the same seed gives the same scans")
      ->check(whole())
      ->capture_default_str();
  for (const simulation::CampusParamInfo& info : simulation::campusParamInfos()) {
    const std::string help = std::string(info.help) + " [" + std::string(info.unit) + "]";
    command->add_option("--" + std::string(info.name), options->params.*info.field, help)
        ->check(CLI::Range(info.min, info.max))
        ->capture_default_str();
  }
  const std::map<std::string, simulation::LaserKind> lasers{{"pan-tilt", simulation::LaserKind::PanTilt},
                                                            {"spinning", simulation::LaserKind::Spinning}};
  command->add_option("--laser", options->params.laser, "pan-tilt, or spinning (64 rings, as on a vehicle)")
      ->transform(CLI::CheckedTransformer(lasers));
  onRun(*command, session, [options, &session] { return simulate(*options, session); });
}

}  // namespace cluxel::app
