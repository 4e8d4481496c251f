// SPDX-License-Identifier: Apache-2.0
// `cluxel doctor` and `cluxel compact`: the integrity and size of a map file.
#include "app/command.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/map_compaction.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/file/map_check.hpp"

namespace cluxel::app {

namespace {

struct UpkeepOptions {
  fs::path map, output;
};

ExitCode compact(const UpkeepOptions& options, const Session& session) {
  std::error_code ignored;
  if (!options.output.empty() && fs::exists(options.output, ignored))
    throw Error(ErrorKind::StoreUnavailable,
                options.output.string() + ": is there already; choose another name or remove it");
  const mapping::CompactedBytes bytes =
      options.output.empty() ? mapping::compactMap(options.map) : mapping::copyCompacted(options.map, options.output);
  const fs::path& written = options.output.empty() ? options.map : options.output;
  if (session.json)
    printJson(Json{{"file", written.string()}, {"bytes_before", bytes.before}, {"bytes_after", bytes.after}});
  else
    std::printf("%s: %ju bytes before, %ju after\n", written.c_str(), static_cast<std::uintmax_t>(bytes.before),
                static_cast<std::uintmax_t>(bytes.after));
  return ExitCode::Done;
}

ExitCode doctor(const UpkeepOptions& options, const Session& session) {
  const rdf::MapCheck check = rdf::checkMap(options.map);
  if (session.json) {
    printJson(Json{{"blocks", check.blocks}, {"terms", check.terms}, {"quads", check.quads}, {"faults", check.faults}});
  } else {
    for (const std::string& fault : check.faults) std::printf("%s\n", fault.c_str());
    std::printf("%llu blocks, %llu terms, %llu quads, %zu faults\n", static_cast<unsigned long long>(check.blocks),
                static_cast<unsigned long long>(check.terms), static_cast<unsigned long long>(check.quads),
                check.faults.size());
  }
  return check.faults.empty() ? ExitCode::Done : ExitCode::NegativeFinding;
}

}  // namespace

void addUpkeep(CLI::App& app, Session& session) {
  auto options = std::make_shared<UpkeepOptions>();
  CLI::App* command = app.add_subcommand("compact", "rewrite a map without free space");
  command->add_option("map", options->map, "a map")->required();
  command->add_option("-o,--output", options->output, "the file to write; default: the map itself is replaced")
      ->check(named());
  onRun(*command, session, [options, &session] { return compact(*options, session); });
  CLI::App* checking = app.add_subcommand("doctor", "verify the checksums and indexes of a map");
  checking->add_option("map", options->map, "a map")->required();
  onRun(*checking, session, [options, &session] { return doctor(*options, session); });
}

}  // namespace cluxel::app
