// SPDX-License-Identifier: Apache-2.0
// `cluxel export`: a map in other formats.
#include "app/command.hpp"
#include "app/map_condition.hpp"
#include "app/shared_options.hpp"
#include "base/file_pieces.hpp"
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

void exportTo(const ExportOptions& options, tasks::ExportFormat format, Session& session, const tasks::ByteSink& out) {
  bool is_exact = true;
  if (const auto store = storeWithoutScans(options.map); store && isRdf(format)) {
    is_exact = exportQuads(*store, format, out);
  } else {
    const mapping::MapReader map(options.map);
    noteUnfinished(options.map, map.isFinished(), options.allow_unfinished, session);
    is_exact =
        exportMap(map, format, out, options.local ? tasks::ExportFrame::Local : tasks::ExportFrame::LongitudeLatitude);
  }
  if (!is_exact)
    session.console.note(options.map.string() +
                         ": its blank nodes are too much alike for canonical labels and keep those of the store, so "
                         "that an equal map may have other bytes");
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
    if (options->output.empty())
      exportTo(*options, format, session,
               [](std::string_view piece) { std::fwrite(piece.data(), 1, piece.size(), stdout); });
    else
      writeFileInPieces(options->output, [&](const auto& take) { exportTo(*options, format, session, take); });
    return ExitCode::Done;
  });
}

}  // namespace cluxel::app
