// SPDX-License-Identifier: Apache-2.0
// `cluxel extend`, `retract`, `repose` and `merge`: a finished map gets other inputs.
#include <set>

#include "app/command.hpp"
#include "app/commands/change_report.hpp"
#include "app/shared_options.hpp"
#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/change/named_clouds.hpp"
#include "mapping/map_reader.hpp"
#include "rdf/file/map_check.hpp"
#include "scan/poses/pose_files.hpp"
#include "tasks/merge_request.hpp"

namespace cluxel::app {

namespace {

struct ChangeOptions {
  fs::path map;
  std::vector<fs::path> inputs;
  std::vector<std::string> clouds;
  ScanOptions scans;
  mapping::ChangeParams change;
  std::size_t listed = 0;
};

ExitCode extend(const ChangeOptions& options, Session& session) {
  mapping::requireChangeable(options.map, options.change);
  for (const fs::path& input : options.inputs)
    if (std::error_code ignored; fs::is_regular_file(input, ignored) && rdf::looksLikeMap(input))
      throw Error(ErrorKind::InvalidArgument, input.string() + ": is a map, not a scan", Remedy::MergeMaps);
  const scan::ScanSet scans = scan::ScanSet::open(options.inputs, options.scans.params(), session.console);
  mapping::ChangeParams params = options.change;
  params.threads = session.threadCount();
  printChange(options.map, extendMap(options.map, scans, params, session.console), params, session, options.listed);
  return ExitCode::Done;
}

ExitCode retract(const ChangeOptions& options, Session& session) {
  mapping::requireChangeable(options.map, options.change);
  mapping::ChangeParams params = options.change;
  params.threads = session.threadCount();
  const auto clouds = mapping::cloudsNamed(options.map, options.clouds, session.console,
                                           {mapping::IncludeRetracted::Yes, mapping::CompareFiles::Yes});
  printChange(options.map, retractScans(options.map, clouds, params, session.console), params, session, options.listed);
  return ExitCode::Done;
}

/// The clouds of the map with the poses that the set gives them. Every scan of the set must be a cloud of the map.
std::vector<mapping::ScanPose> posesOf(const scan::ScanSet& scans, const fs::path& map, ProgressSink& sink) {
  const mapping::MapReader reader(map);
  requireFrame(reader.inputs(), scans);
  std::set<scan::ScanId> known;
  for (const mapping::Cloud& cloud : reader.clouds()) known.insert(cloud.id);
  std::vector<mapping::ScanPose> poses;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (!scans.file(i).has_pose)
      throw Error(ErrorKind::FaultyInput, scans.file(i).path.string() + ": has no pose to give to the map's cloud",
                  Remedy::NamePoses);
    poses.push_back({scans.load(i).id, scans.file(i).T_map_sensor});
    if (!known.contains(poses.back().scan))
      throw Error(ErrorKind::NotFound, map.string() + ": does not hold the scan " + scans.file(i).path.string(),
                  Remedy::ListClouds);
    sink.progress("reading", i + 1, scans.size());
  }
  return poses;
}

ExitCode repose(const ChangeOptions& options, Session& session) {
  mapping::requireChangeable(options.map, options.change);
  const scan::ScanSet scans = scan::ScanSet::open(options.inputs, options.scans.params(), session.console);
  mapping::ChangeParams params = options.change;
  params.threads = session.threadCount();
  const auto poses = posesOf(scans, options.map, session.console);
  printChange(options.map, moveScans(options.map, poses, params, session.console), params, session, options.listed);
  return ExitCode::Done;
}

struct MergeOptions {
  std::vector<fs::path> maps;
  fs::path output, transform, use;
  mapping::MergeParams params;
  std::size_t listed = 0;
};

ExitCode merge(const MergeOptions& options, Session& session) {
  std::vector<mapping::MapToMerge> maps;
  for (const fs::path& file : options.maps) maps.push_back({file, Eigen::Isometry3d::Identity()});
  if (!options.transform.empty())
    tasks::setTransform(maps, scan::parseTransform(readFile(options.transform), options.transform.string()));
  mapping::MergeParams params = options.params;
  params.change.threads = session.threadCount();
  if (!options.use.empty()) params.use = tasks::numberAmong(maps, options.use);
  printChange(options.output, mergeMaps(maps, options.output, params, session.console), params.change, session,
              options.listed);
  return ExitCode::Done;
}

}  // namespace

void addChange(CLI::App& app, Session& session) {
  auto options = std::make_shared<ChangeOptions>();
  CLI::App* extending = app.add_subcommand("extend", "add scans to a map");
  extending->add_option("map", options->map, "a finished map")->required();
  extending->add_option("scans", options->inputs, "files, folders and manifests of scans")->required();
  addScanOptions(*extending, options->scans);
  addChangeOptions(*extending, options->change, true);
  addListed(*extending, options->listed);
  onRun(*extending, session, [options, &session] { return extend(*options, session); });

  CLI::App* retracting = app.add_subcommand("retract", "remove scans from a map");
  retracting->add_option("map", options->map, "a finished map")->required();
  retracting->add_option("clouds", options->clouds, "clouds by id (four digits or more) or file name")->required();
  addChangeOptions(*retracting, options->change, true);
  addListed(*retracting, options->listed);
  onRun(*retracting, session, [options, &session] { return retract(*options, session); });

  CLI::App* reposing = app.add_subcommand("repose", "give scans of a map other poses, as after a loop closure");
  reposing->add_option("map", options->map, "a finished map")->required();
  reposing->add_option("scans", options->inputs, "the scans, with their new poses: what 'register' writes")->required();
  addScanOptions(*reposing, options->scans);
  addChangeOptions(*reposing, options->change, true);
  addListed(*reposing, options->listed);
  onRun(*reposing, session, [options, &session] { return repose(*options, session); });

  auto merging = std::make_shared<MergeOptions>();
  CLI::App* command = app.add_subcommand("merge", "make one map of several");
  command->add_option("maps", merging->maps, "finished maps")->required()->expected(2, -1);
  command->add_option("-o,--output", merging->output, "the map file to make")->required()->check(named());
  command->add_option("--transform", merging->transform,
                      "a file with the 4x4 or 3x4 matrix from the second map to the first");
  command->add_option("--use", merging->use, "the map whose ontology, rules and model are used, when they differ");
  CLI::Option* force = command->add_flag("--force", merging->params.force, "replace another map that is there");
  command
      ->add_flag("--drop-statements", merging->params.drop_statements,
                 "with --force: also when that map has operator statements of its own, which are lost")
      ->needs(force);
  addChangeOptions(*command, merging->params.change, true);
  addListed(*command, merging->listed);
  onRun(*command, session, [merging, &session] { return merge(*merging, session); });
}

}  // namespace cluxel::app
