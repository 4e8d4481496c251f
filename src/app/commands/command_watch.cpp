// SPDX-License-Identifier: Apache-2.0
// `cluxel watch`: extends a map by the scans that arrive in a folder.
#include "app/command.hpp"
#include "app/shared_options.hpp"
#include "app/stop_signals.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/work_file.hpp"
#include "mapping/map_state.hpp"
#include "mapping/watch/folder_watch.hpp"

namespace cluxel::app {

namespace {

struct WatchOptions {
  fs::path folder, map;
  ScanOptions scans;
  mapping::MapInputFiles files;
  mapping::WatchParams params;
};

void report(const WatchOptions& options, const mapping::WatchCommit& commit, bool as_json) {
  if (as_json)
    printJsonLine(Json{{"map", options.map.string()},
                       {"added", commit.added},
                       {"scans", commit.scans},
                       {"objects", commit.objects},
                       {"tiles_decided", commit.tiles_decided},
                       {"objects_added", commit.objects_added},
                       {"objects_changed", commit.objects_changed},
                       {"objects_redecided", commit.objects_redecided},
                       {"objects_gone", commit.objects_gone},
                       {"objects_split", commit.objects_split},
                       {"objects_joined", commit.objects_joined}});
  else
    std::printf(
        "%s: %zu new, %zu scans, %zu objects (%zu added, %zu changed, %zu redecided, %zu gone, %zu from splits, %zu "
        "joined; %zu tiles decided)\n",
        options.map.c_str(), commit.added, commit.scans, commit.objects, commit.objects_added, commit.objects_changed,
        commit.objects_redecided, commit.objects_gone, commit.objects_split, commit.objects_joined,
        commit.tiles_decided);
  std::fflush(stdout);
}

/// A map keeps its model and rules. They may be named again, so that the command that made the map goes on.
void refuseOtherInputs(const WatchOptions& options, const Session& session) {
  if ((options.files.model.empty() && options.files.rules.empty()) || mapping::hasBuildToDo(options.map)) return;
  const mapping::MapInputs inputs =
      mapping::requireFinishedInputs(rdf::Environment::open(options.map, rdf::OpenMode::ReadOnly)->read(), options.map);
  if (withNamedFiles(inputs, options.files, session.dataHome()).hash() == inputs.hash()) return;
  throw Error(ErrorKind::InvalidArgument,
              options.map.string() +
                  ": has another model or other rules than --model and --rules name, and watch keeps "
                  "what a map has; leave them out, or change the map with 'cluxel rules apply'");
}

ExitCode watch(const WatchOptions& options, Session& session) {
  refuseOtherInputs(options, session);
  mapping::WatchParams params = options.params;
  params.threads = session.threadCount();
  params.scans = options.scans.params();
  mapping::WatchCallbacks callbacks;
  callbacks.inputs = [&] { return readMapInputs(options.files, session.dataHome()); };
  callbacks.committed = [&](const mapping::WatchCommit& commit) { report(options, commit, session.json); };
  const StopSignals signals;
  bool is_stopped = false;
  callbacks.is_stopped = [&] { return is_stopped = is_stopped || signals.arrived(); };
  const std::size_t added = watchFolder(options.folder, options.map, params, callbacks, session.console);
  return added == 0 ? ExitCode::NoRows : ExitCode::Done;
}

}  // namespace

void addWatch(CLI::App& app, Session& session) {
  auto options = std::make_shared<WatchOptions>();
  CLI::App* command = app.add_subcommand("watch", "extend a map by the scans that arrive in a folder");
  command->add_option("folder", options->folder, "the folder in which scans arrive")->required()->check(named());
  command->add_option("-o,--output", options->map, "the map; it is created when it does not exist")
      ->required()
      ->check(named());
  addScanOptions(*command, options->scans);
  command->add_option("--interval", options->params.interval_s, "time between two looks at the folder [s, 1]")
      ->check(within({.min = 0.05, .max = 3600}));
  command->add_option("--idle", options->params.idle_s, "end when nothing has changed for this time [s]; 0: never")
      ->check(within({.min = 0, .max = 1e6}));
  command->add_option("--model", options->files.model,
                      "for a new map: a trained model, as a name in models/ or a file");
  command->add_option("--rules", options->files.rules, "for a new map: rule files instead of rules/outdoor.rules.yaml");
  onRun(*command, session, [options, &session] { return watch(*options, session); });
}

}  // namespace cluxel::app
