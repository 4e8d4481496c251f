// SPDX-License-Identifier: Apache-2.0
// `cluxel register`: refines the poses of scans, or measures how well they fit.
#include <algorithm>
#include <numbers>

#include "app/command.hpp"
#include "app/shared_options.hpp"
#include "cluxel/error.hpp"
#include "scan/formats/manifest_writer.hpp"
#include "scan/registration/pose_registration.hpp"

namespace cluxel::app {

namespace {

struct RegisterOptions {
  std::vector<fs::path> inputs;
  fs::path poses, output;
  scan::RegistrationParams params;
  double max_residual_m = scan::kFittingResidual_m;
  bool check = false, force = false;
};

constexpr double kDegrees = 180 / std::numbers::pi;

void refuseWrongOutput(const RegisterOptions& options) {
  if (options.check == !options.output.empty())
    throw Error(ErrorKind::InvalidArgument, options.check
                                                ? "register --check writes nothing: leave out -o"
                                                : "register needs -o FILE.yaml for the refined poses, or --check");
  if (options.check) return;
  const std::string ending = options.output.extension().string();
  if (ending != ".yaml" && ending != ".yml")
    throw Error(ErrorKind::InvalidArgument,
                options.output.string() + ": what register writes is a manifest: name it *.yaml");
  std::error_code fault;
  const bool is_there = fs::exists(options.output, fault);
  if (fault)
    throw Error(ErrorKind::StoreUnavailable, options.output.string() + ": cannot be written: " + fault.message());
  if (is_there && !options.force)
    throw Error(ErrorKind::StoreUnavailable,
                options.output.string() + " exists already: name another file, or give --force to replace it");
  refuseToReplaceMap(options.output);
}

Json pairJson(const scan::RegisteredPair& pair, const scan::PoseRegistration& report, const scan::ScanSet& set) {
  const auto source = [&](std::size_t i) { return set.file(report.scans[i].index).path.string(); };
  return {{"first", source(pair.first)},
          {"second", source(pair.second)},
          {"outcome", nameOf(pair.outcome)},
          {"overlap", pair.overlap},
          {"residual_before_m", pair.residual_before_m},
          {"residual_after_m", pair.residual_after_m}};
}

Json reportJson(const scan::PoseRegistration& report, const scan::ScanSet& set) {
  Json json{{"residual_before_m", report.residual_before_m}, {"residual_after_m", report.residual_after_m}};
  json["scans"] = Json::array();
  for (const scan::RefinedScan& scan : report.scans)
    json["scans"].push_back(Json{{"source", set.file(scan.index).path.string()},
                                 {"shift_m", scan.shift_m},
                                 {"turn_deg", scan.turn_rad * kDegrees},
                                 {"pairs", scan.pairs},
                                 {"group", scan.group}});
  json["pairs"] = Json::array();
  for (const scan::RegisteredPair& pair : report.pairs) json["pairs"].push_back(pairJson(pair, report, set));
  return json;
}

/// Groups of two scans or more.
std::size_t groupsIn(const scan::PoseRegistration& report) {
  std::size_t groups = 0;
  for (std::size_t i = 0; i < report.scans.size(); ++i)
    if (report.scans[i].pairs > 0 && report.scans[i].group == i) ++groups;
  return groups;
}

/// Prints the pairs that were left out, by name; then each scan with its correction.
void printReport(const scan::PoseRegistration& report, const scan::ScanSet& set, bool check) {
  const auto source = [&](std::size_t i) { return set.file(report.scans[i].index).path.string(); };
  std::size_t used = 0;
  for (const scan::RegisteredPair& pair : report.pairs) {
    if (pair.outcome == scan::PairOutcome::Used) ++used;
    if (pair.outcome != scan::PairOutcome::Used || check)
      std::printf("%s%s - %s: %s (overlap %.2f, residual %.3f m)\n",
                  check ? "" : "left out: ", source(pair.first).c_str(), source(pair.second).c_str(),
                  check && pair.outcome == scan::PairOutcome::Used ? "measured" : nameOf(pair.outcome), pair.overlap,
                  pair.residual_after_m);
  }
  for (const scan::RefinedScan& scan : report.scans) {
    if (check) continue;
    std::printf("%s: moved by %.3f m and %.3f degrees, %zu pairs%s\n", set.file(scan.index).path.c_str(), scan.shift_m,
                scan.turn_rad * kDegrees, scan.pairs, scan.pairs == 0 ? ": keeps its pose" : "");
  }
  if (groupsIn(report) > 1)
    std::printf("%zu groups of scans that no pair joins: their relative poses stay as given\n", groupsIn(report));
  if (used == 0) std::printf("no two scans overlap enough to be aligned\n");
  std::printf("%zu scans, %zu of %zu pairs used, median residual %.3f m", report.scans.size(), used,
              report.pairs.size(), report.residual_before_m);
  std::printf(check ? "\n" : " before, %.3f m after\n", report.residual_after_m);
}

/// Whether measured pairs join all scans.
bool areCompared(const scan::PoseRegistration& report) {
  return std::all_of(report.scans.begin(), report.scans.end(),
                     [&](const scan::RefinedScan& scan) { return scan.group == report.scans.front().group; });
}

/// Names the scans that no measured pairs join to the first.
void printNotCompared(const scan::PoseRegistration& report, const scan::ScanSet& set) {
  for (const scan::RefinedScan& scan : report.scans)
    if (scan.group != report.scans.front().group)
      std::printf("no measured pairs join %s to %s: its pose may be wrong\n", set.file(scan.index).path.c_str(),
                  set.file(report.scans.front().index).path.c_str());
}

ExitCode checkPoses(const RegisterOptions& options, const scan::ScanSet& set, Session& session) {
  const scan::PoseRegistration report = measurePoses(set, options.params, session.threadCount(), session.console);
  double worst_m = 0;
  for (const scan::RegisteredPair& pair : report.pairs)
    if (pair.outcome == scan::PairOutcome::Used) worst_m = std::max(worst_m, pair.residual_before_m);
  const bool all_compared = areCompared(report);
  const bool fits = all_compared && worst_m <= options.max_residual_m;
  if (session.json) {
    Json json = reportJson(report, set);
    json["worst_residual_m"] = worst_m;
    json["all_compared"] = all_compared;
    json["fits"] = fits;
    printJson(json);
  } else {
    printReport(report, set, true);
    const bool has_measured = std::any_of(report.scans.begin(), report.scans.end(),
                                          [](const scan::RefinedScan& scan) { return scan.pairs > 0; });
    if (has_measured)
      std::printf("worst residual %.6g m: %s --max-residual %g m\n", worst_m,
                  worst_m <= options.max_residual_m ? "within" : "above", options.max_residual_m);
    printNotCompared(report, set);
  }
  return fits ? ExitCode::Done : ExitCode::NegativeFinding;
}

ExitCode registerScans(const RegisterOptions& options, Session& session) {
  refuseWrongOutput(options);
  const scan::ScanSet set = scan::ScanSet::open(options.inputs, {options.poses}, session.console);
  if (options.check) return checkPoses(options, set, session);
  const scan::PoseRegistration report = registerPoses(set, options.params, session.threadCount(), session.console);
  writeOutput(options.output, manifestText(set, report.poses(), options.output, "poses refined by cluxel register"));
  if (session.json)
    printJson(reportJson(report, set));
  else
    printReport(report, set, false);
  return ExitCode::Done;
}

}  // namespace

void addRegister(CLI::App& app, Session& session) {
  auto options = std::make_shared<RegisterOptions>();
  CLI::App* command = app.add_subcommand("register", "refine the poses of scans by registering overlapping scans");
  command->add_option("scans", options->inputs, "files, folders and manifests of scans")->required();
  command->add_option("-o,--output", options->output, "the manifest to write, *.yaml, which build takes")
      ->check(named());
  command->add_option("--poses", options->poses, "poses of the scans: KITTI 3x4, TUM, or 4x4 text");
  command->add_flag("--check", options->check, "only measure; exit code 1 when scans do not fit");
  command->add_option("--max-residual", options->max_residual_m, "with --check: how far surfaces may be apart [m]")
      ->check(above0())
      ->capture_default_str();
  command
      ->add_option("--reach", options->params.reach_m, "how wrong the relative poses of neighbouring scans may be [m]")
      ->check(above0())
      ->capture_default_str();
  command->add_flag("--force", options->force, "replace the manifest");
  onRun(*command, session, [options, &session] { return registerScans(*options, session); });
}

}  // namespace cluxel::app
