// SPDX-License-Identifier: Apache-2.0
// `cluxel doctor` and `cluxel compact`: the health and size of a map file.
#include "app/command.hpp"
#include "cluxel/base/diagnostic.hpp"
#include "cluxel/knowledge/environment.hpp"

namespace cluxel::app {

namespace {

struct UpkeepOptions {
  fs::path map, output;
};

ExitCode compact(const UpkeepOptions& options, const Session& session) {
  const auto before = fs::file_size(options.map);
  fs::path target = options.output;
  if (target.empty()) target = options.map.string() + ".compact";
  Environment::open(options.map, OpenMode::ReadOnly)->compactTo(target);
  const auto after = fs::file_size(target);
  if (options.output.empty()) fs::rename(target, options.map);
  const fs::path& written = options.output.empty() ? options.map : options.output;
  if (session.json)
    printJson(Json{{"file", written.string()}, {"bytes_before", before}, {"bytes_after", after}});
  else
    std::printf("%s: %ju bytes before, %ju after\n", written.c_str(), static_cast<std::uintmax_t>(before),
                static_cast<std::uintmax_t>(after));
  return ExitCode::Done;
}

}  // namespace

void addUpkeep(CLI::App& app, Session& session) {
  auto options = std::make_shared<UpkeepOptions>();
  CLI::App* command = app.add_subcommand("compact", "rewrite a map without free space");
  command->add_option("map", options->map, "a map")->required()->check(CLI::ExistingFile);
  command->add_option("-o,--output", options->output, "the file to write; else the map itself is replaced");
  onRun(*command, session, [options, &session] { return compact(*options, session); });
}

}  // namespace cluxel::app
