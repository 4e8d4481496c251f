// SPDX-License-Identifier: Apache-2.0
// `cluxel export`: a map in other formats.
#include "app/command.hpp"
#include "app/map_condition.hpp"
#include "app/shared_options.hpp"
#include "cluxel/error.hpp"
#include "tasks/export/map_export.hpp"

namespace cluxel::app {

namespace {

struct ExportOptions {
  fs::path map, output;
  std::string format;
  bool canonical = false, local = false, allow_unfinished = false;
};

tasks::ExportFormat formatOf(const ExportOptions& options) {
  if (options.canonical) return tasks::ExportFormat::Canonical;
  std::string name = options.format;
  if (name.empty() && options.output.has_extension()) name = options.output.extension().string().substr(1);
  if (const auto format = tasks::exportFormatOf(name)) return *format;
  throw Error(ErrorKind::InvalidArgument, "export: unknown format '" + name +
                                              "'; write --format turtle, nquads, canonical, ply or "
                                              "geojson, or an output file that ends in .ttl, .nq, .ply or .geojson");
}

}  // namespace

void addExport(CLI::App& app, Session& session) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand("export", "write a map as RDF, a coloured cloud or footprints");
  command->add_option("map", options->map, "a map")->required();
  command->add_option("-o,--output", options->output, "the file to write; default: stdout")->check(named());
  command->add_option("--format", options->format,
                      "turtle, nquads, canonical, ply, geojson; default: by the file's ending");
  command->add_flag("--canonical", options->canonical, "sorted N-Quads without history: equal bytes mean equal maps");
  command->add_flag("--local", options->local,
                    "write GeoJSON in metres of the map frame instead of longitude and latitude");
  addAllowUnfinished(*command, options->allow_unfinished);
  onRun(*command, session, [options, &session] {
    const tasks::ExportFormat format = formatOf(*options);
    refuseToReplaceMap(options->output);
    std::string bytes;
    const bool to_stdout = options->output.empty();
    const auto write = [&](std::string_view piece) {
      if (to_stdout)
        std::fwrite(piece.data(), 1, piece.size(), stdout);
      else
        bytes.append(piece);
    };
    bool is_exact = true;
    if (const auto store = storeWithoutScans(options->map); store && isRdf(format)) {
      is_exact = exportQuads(*store, format, write);
    } else {
      const mapping::MapReader map(options->map);
      noteUnfinished(options->map, map.isFinished(), options->allow_unfinished, session);
      is_exact = exportMap(map, format, write,
                           options->local ? tasks::ExportFrame::Local : tasks::ExportFrame::LongitudeLatitude);
    }
    if (!is_exact)
      session.console.note(options->map.string() +
                           ": its blank nodes are too much alike for canonical labels and keep those of the store, so "
                           "that an equal map may have other bytes");
    if (!to_stdout) writeOutput(options->output, bytes);
    return ExitCode::Done;
  });
}

}  // namespace cluxel::app
