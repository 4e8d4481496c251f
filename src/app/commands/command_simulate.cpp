// SPDX-License-Identifier: Apache-2.0
// `cluxel simulate`: scans of a generated campus with truth and poses.
#include <charconv>
#include <map>
#include <optional>

#include "app/command.hpp"
#include "cluxel/error.hpp"
#include "scan/truth/truth.hpp"
#include "simulation/laser/campus_writer.hpp"
#include "simulation/laser/city_writer.hpp"

namespace cluxel::app {

namespace {

struct SimulateOptions {
  fs::path folder;
  simulation::CampusParams params;
  std::string city, districts;
};

/// "12x8" with the separator "x" as two numbers.
std::optional<std::pair<std::size_t, std::size_t>> twoNumbers(std::string_view text, std::string_view separator) {
  const char* const end = text.data() + text.size();
  std::size_t first = 0, second = 0;
  const auto [middle, fault] = std::from_chars(text.data(), end, first);
  if (fault != std::errc() || !std::string_view(middle, end).starts_with(separator)) return std::nullopt;
  const auto [rest, other_fault] = std::from_chars(middle + separator.size(), end, second);
  if (other_fault != std::errc() || rest != end) return std::nullopt;
  return std::pair(first, second);
}

simulation::City cityOf(const SimulateOptions& options) {
  const auto grid = twoNumbers(options.city, "x");
  if (!grid)
    throw Error(ErrorKind::InvalidArgument, "--city: write COLUMNSxROWS, for example 8x6, not '" + options.city + "'");
  return simulation::City({.district = options.params, .columns = grid->first, .rows = grid->second});
}

simulation::DistrictRange rangeOf(const SimulateOptions& options, const simulation::City& city) {
  if (options.districts.empty()) return {.first = 0, .last = city.size() - 1};
  const auto range = twoNumbers(options.districts, "..");
  if (!range)
    throw Error(ErrorKind::InvalidArgument,
                "--districts: write FIRST..LAST, for example 0..3, not '" + options.districts + "'");
  return {.first = range->first, .last = range->second};
}

ExitCode report(const simulation::CampusSummary& summary, const SimulateOptions& options, std::size_t districts,
                const Session& session) {
  if (session.json) {
    Json classes = Json::object();
    for (std::size_t i = 0; i < summary.objects_of_class.size(); ++i)
      classes[scan::truthClassNames()[i]] = summary.objects_of_class[i];
    Json json{{"folder", options.folder.string()}, {"seed", options.params.seed}};
    if (districts > 0) json["districts"] = districts;
    json["scans"] = summary.scans;
    json["points"] = summary.points;
    json["objects"] = summary.objects;
    json["objects_by_class"] = classes;
    printJson(json);
    return ExitCode::Done;
  }
  const std::string parts = districts > 0 ? std::to_string(districts) + " districts, " : "";
  std::printf("%s: %s%zu scans, %zu points, %zu objects (generated, seed %llu)\n", options.folder.c_str(),
              parts.c_str(), summary.scans, summary.points, summary.objects,
              static_cast<unsigned long long>(options.params.seed));
  return ExitCode::Done;
}

ExitCode simulate(const SimulateOptions& options, Session& session) {
  const unsigned threads = session.threadCount();
  if (options.city.empty()) {
    check(options.params);
    const simulation::Campus campus = buildCampus(options.params);
    return report(writeCampus(campus, options.folder, threads, session.console), options, 0, session);
  }
  const simulation::City city = cityOf(options);
  const simulation::DistrictRange range = rangeOf(options, city);
  const simulation::CampusSummary summary = writeCity(city, range, options.folder, threads, session.console);
  return report(summary, options, range.last - range.first + 1, session);
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
        ->check(within({.min = info.min, .max = info.max}))
        ->capture_default_str();
  }
  const std::map<std::string, simulation::LaserKind> lasers{{"pan-tilt", simulation::LaserKind::PanTilt},
                                                            {"spinning", simulation::LaserKind::Spinning}};
  command->add_option("--laser", options->params.laser, "pan-tilt, or spinning (64 rings, as on a vehicle)")
      ->transform(wordFor(lasers, "LASER"));
  CLI::Option* city =
      command->add_option("--city", options->city, "a grid of such campuses, made one after the other: COLUMNSxROWS");
  command->add_option("--districts", options->districts, "write only these campuses of the city: FIRST..LAST, from 0")
      ->needs(city);
  onRun(*command, session, [options, &session] { return simulate(*options, session); });
}

}  // namespace cluxel::app
