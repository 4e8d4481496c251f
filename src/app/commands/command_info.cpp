// SPDX-License-Identifier: Apache-2.0
// `cluxel info`: the contents of scans or of a map.
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "app/command.hpp"
#include "app/map_condition.hpp"
#include "app/shared_options.hpp"
#include "base/utc_time.hpp"
#include "cluxel/error.hpp"
#include "mapping/clouds/ray_starts.hpp"
#include "mapping/map_reader.hpp"
#include "mapping/origin_text.hpp"
#include "rdf/file/map_check.hpp"
#include "scan/scan_summary.hpp"
#include "tasks/plots/map_plots.hpp"

namespace cluxel::app {

namespace {

struct InfoOptions {
  std::vector<fs::path> inputs;
  ScanOptions scans;
  fs::path html;
  bool clouds = false, layers = false;
};

Json boxJson(const Eigen::AlignedBox3d& box) {
  if (box.isEmpty()) return nullptr;
  return {{"min", {box.min().x(), box.min().y(), box.min().z()}},
          {"max", {box.max().x(), box.max().y(), box.max().z()}}};
}

std::string nameOfLabel(std::uint32_t label) {
  return label == scan::kNoLabel ? "none" : std::to_string(label);
}

Json labelsJson(const std::map<std::uint32_t, std::size_t>& labels) {
  Json json = Json::object();
  for (const auto& [label, count] : labels) json[nameOfLabel(label)] = count;
  return json;
}

Json scanJson(const scan::ScanSummary& scan) {
  Json json{{"source", scan.source},
            {"format", nameOf(scan.format)},
            {"id", scan.id.hex()},
            {"points", scan.point_count},
            {"extent_map_m", boxJson(scan.extent_map_m)},
            {"has_pose", scan.has_pose},
            {"has_intensity", scan.has_intensity},
            {"has_origins", scan.has_origins},
            {"labels", labelsJson(scan.points_by_label)}};
  json["frame"] = scan.has_pose ? "sensor, posed in map" : "map";
  if (scan.time_s) json["time_s"] = *scan.time_s;
  return json;
}

std::string sizeText(const Eigen::AlignedBox3d& box) {
  if (box.isEmpty()) return "-";
  char text[128];
  std::snprintf(text, sizeof text, "%.1f x %.1f x %.1f m", box.sizes().x(), box.sizes().y(), box.sizes().z());
  return text;
}

void printScans(const scan::ScanSetSummary& summary) {
  for (const scan::ScanSummary& scan : summary.scans) {
    std::printf("%s  %s  %zu points  %s  %s%s%s%s\n", scan.source.c_str(), nameOf(scan.format), scan.point_count,
                sizeText(scan.extent_map_m).c_str(), scan.has_pose ? "posed" : "no pose: in the map frame",
                scan.has_origins ? "  origins of rays" : "", scan.has_intensity ? "  intensity" : "",
                scan.points_by_label.empty() ? "" : "  labels");
  }
  std::printf("%zu scans, %zu points, extent %s\n", summary.scans.size(), summary.point_count,
              sizeText(summary.extent_map_m).c_str());
  if (!summary.crs.empty()) std::printf("coordinate system: %s\n", summary.crs.c_str());
  if (summary.points_by_label.empty()) return;
  std::printf("labels:");
  for (const auto& [label, count] : summary.points_by_label) std::printf(" %s:%zu", nameOfLabel(label).c_str(), count);
  std::printf("\n");
}

void refuseFigures(const InfoOptions& options, const std::string& what) {
  if (!options.html.empty())
    throw Error(ErrorKind::InvalidArgument, what + ", which has no figures; --html needs a map with objects");
}

ExitCode infoOfScans(const InfoOptions& options, Session& session) {
  refuseFigures(options, options.inputs.front().string() + ": is not a map");
  const scan::ScanSet scans = scan::ScanSet::open(options.inputs, options.scans.params(), session.console);
  const scan::ScanSetSummary summary = summarize(scans, session.threadCount());
  for (const std::string& note : summary.notes) session.console.note(note);
  if (!session.json) {
    printScans(summary);
    return ExitCode::Done;
  }
  Json json{{"scans", Json::array()},
            {"points", summary.point_count},
            {"extent_map_m", boxJson(summary.extent_map_m)},
            {"labels", labelsJson(summary.points_by_label)}};
  if (!summary.crs.empty()) json["crs"] = summary.crs;
  for (const scan::ScanSummary& scan : summary.scans) json["scans"].push_back(scanJson(scan));
  printJson(json);
  return ExitCode::Done;
}

Json namesJson(const std::vector<mapping::NamedText>& texts) {
  Json json = Json::array();
  for (const mapping::NamedText& text : texts) json.push_back(text.name);
  return json;
}

Json inputFilesJson(const mapping::MapInputs& inputs) {
  return {{"home", inputs.home},
          {"ontology", namesJson(inputs.ontology)},
          {"rules", namesJson(inputs.rules)},
          {"sparql_rules", namesJson(inputs.sparql_rules)},
          {"model", inputs.model.name}};
}

/// Decides by the content, and by the ending of the name, so that a damaged or absent map is reported as such.
bool isMap(const fs::path& input) {
  return input.extension() == ".clx" || rdf::looksLikeMap(input);
}

/// A pose as rows of four numbers.
Json poseJson(const Eigen::Isometry3d& T) {
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row) {
    Json numbers = Json::array();
    for (int column = 0; column < 4; ++column) numbers.push_back(T.matrix()(row, column));
    rows.push_back(std::move(numbers));
  }
  return rows;
}

Json cloudsJson(const mapping::MapReader& map) {
  Json json = Json::array();
  for (const mapping::Cloud& cloud : map.clouds()) {
    Json entry{{"id", cloud.id.hex()},
               {"source", cloud.source},
               {"points", cloud.point_count},
               {"has_pose", cloud.has_pose},
               {"extent_map_m", boxJson({cloud.min, cloud.max})}};
    if (cloud.has_pose) entry["T_map_sensor"] = poseJson(cloud.T_map_sensor);
    const std::vector<Eigen::Vector3d> starts = mapping::rayStartsOf(map.transaction(), cloud);
    if (!starts.empty()) entry["sensor"] = {starts[0].x(), starts[0].y(), starts[0].z()};
    if (!starts.empty() && !mapping::sensorPlaceOf(cloud)) entry["sensor_moved"] = true;
    if (cloud.time_s) entry["time_s"] = *cloud.time_s;
    json.push_back(std::move(entry));
  }
  return json;
}

void printCloud(const mapping::MapReader& map, const mapping::Cloud& cloud) {
  std::printf("  cloud %s  %llu points  %s", cloud.id.hex().c_str(), static_cast<unsigned long long>(cloud.point_count),
              cloud.source.c_str());
  if (!cloud.has_pose) std::printf("  no pose");
  const std::vector<Eigen::Vector3d> starts = mapping::rayStartsOf(map.transaction(), cloud);
  if (!starts.empty())
    std::printf("  sensor %s %.2f %.2f %.2f m", mapping::sensorPlaceOf(cloud) ? "at" : "moved, at last at",
                starts[0].x(), starts[0].y(), starts[0].z());
  std::printf("%s%s\n", cloud.time_s ? "  " : "", cloud.time_s ? dateTimeText(*cloud.time_s).c_str() : "");
}

/// What the named file takes on the disk, without its holes. The reader may read a private copy of it.
std::uint64_t diskBytesOf(const fs::path& map) {
  constexpr std::uint64_t kBlock = 512;  // of st_blocks, on every file system
  struct stat status {};
  if (::stat(map.c_str(), &status) != 0)
    throw Error(ErrorKind::StoreUnavailable, map.string() + ": cannot be examined (" +
                                                 std::generic_category().message(errno) +
                                                 "); check that it is still there");
  return static_cast<std::uint64_t>(status.st_blocks) * kBlock;
}

Json layersJson(const std::vector<rdf::LayerSize>& layers) {
  Json json = Json::array();
  for (const rdf::LayerSize& layer : layers)
    json.push_back({{"name", layer.name}, {"entries", layer.entries}, {"bytes", layer.file_bytes}});
  return json;
}

void printLayers(const std::vector<rdf::LayerSize>& layers, std::uint64_t disk_bytes, std::uint64_t points) {
  const auto row = [points](const std::string& name, const std::string& entries, std::uint64_t bytes) {
    std::printf("  layer %-18s %10s entries %12ju bytes %8.2f a point\n", name.c_str(), entries.c_str(),
                static_cast<std::uintmax_t>(bytes), static_cast<double>(bytes) / static_cast<double>(points));
  };
  std::uint64_t all = 0;
  for (const rdf::LayerSize& layer : layers) {
    row(layer.name, std::to_string(layer.entries), layer.file_bytes);
    all += layer.file_bytes;
  }
  row("all", "", all);
  row("all, on the disk", "", disk_bytes);
}

Json heightsJson(const std::vector<tasks::PlotSpread>& heights) {
  Json json = Json::object();
  for (const tasks::PlotSpread& spread : heights)
    json[spread.label] = {{"objects", spread.count}, {"least", spread.least},          {"lower_quartile", spread.lower},
                          {"median", spread.middle}, {"upper_quartile", spread.upper}, {"greatest", spread.most}};
  return json;
}

Json runsJson(const std::vector<tasks::MapRun>& runs) {
  Json json = Json::array();
  for (const tasks::MapRun& run : runs) {
    Json stages = Json::array();
    for (const auto& [name, seconds] : run.stages) stages.push_back({{"stage", name}, {"seconds", seconds}});
    json.push_back({{"operation", run.operation},
                    {"started", run.started},
                    {"seconds", run.seconds},
                    {"scans", run.scans},
                    {"stages", std::move(stages)}});
  }
  return json;
}

void writeMapFigures(const InfoOptions& options, const fs::path& map, const tasks::MapFigures& figures) {
  refuseToReplaceMap(options.html);
  writeOutput(options.html, tasks::plotPage(tasks::mapPlots(figures, map.stem().string())));
}

ExitCode infoOfStore(const fs::path& file, const rdf::QuadReader& quads, const Session& session) {
  Json graphs = Json::object();
  for (const rdf::TermId graph : quads.graphs())
    graphs[graph == rdf::kNoTerm ? "" : quads.termOf(graph).text] =
        quads.count({.s = {}, .p = {}, .o = {}, .g = graph});
  if (session.json) {
    printJson(Json{{"file", file.string()}, {"quads", quads.size()}, {"terms", quads.termCount()}, {"graphs", graphs}});
    return ExitCode::Done;
  }
  std::printf("%s: store without scans, %llu quads, %zu graphs\n", file.c_str(),
              static_cast<unsigned long long>(quads.size()), graphs.size());
  for (const auto& [name, count] : graphs.items())
    std::printf("  %10llu  %s\n", count.get<unsigned long long>(),
                name.empty() ? "the unnamed graph" : ("<" + name + ">").c_str());
  return ExitCode::Done;
}

ExitCode infoOfMap(const InfoOptions& options, const fs::path& file, const Session& session) {
  if (const auto store = storeWithoutScans(file)) {
    refuseFigures(options, file.string() + ": is a store without scans");
    return infoOfStore(file, *store, session);
  }
  const mapping::MapReader map(file);
  const mapping::MapSummary summary = map.summary();
  const mapping::MapInputs inputs = map.inputs();
  std::optional<tasks::MapFigures> figures;
  if (session.json || !options.html.empty()) figures = tasks::mapFigures(map);
  if (!options.html.empty()) writeMapFigures(options, file, *figures);
  if (!session.json) {
    std::printf("%s: %s map, %zu clouds, %llu points, %zu objects, %llu quads\n", file.c_str(),
                summary.is_finished ? "finished" : "unfinished", summary.clouds,
                static_cast<unsigned long long>(summary.points), summary.objects,
                static_cast<unsigned long long>(summary.quads));
    for (const auto& [name, count] : summary.objects_by_class) std::printf("  %-14s %zu\n", name.c_str(), count);
    if (options.clouds)
      for (const mapping::Cloud& cloud : map.clouds()) printCloud(map, cloud);
    if (options.layers) printLayers(map.layers(), diskBytesOf(file), summary.points);
    if (!inputs.crs.empty()) std::printf("coordinate system: %s\n", inputs.crs.c_str());
    if (!inputs.map_origin.isZero(0)) std::printf("map_origin: %s m\n", mapping::originText(inputs.map_origin).c_str());
    std::printf("built with %s\n", describeFiles(inputs).c_str());
    return ExitCode::Done;
  }
  Json json{{"file", file.string()},         {"finished", summary.is_finished},
            {"inputs", summary.inputs_hash}, {"clouds", summary.clouds},
            {"points", summary.points},      {"objects", summary.objects},
            {"quads", summary.quads},        {"objects_by_class", summary.objects_by_class}};
  if (options.clouds) json["cloud_list"] = cloudsJson(map);
  if (options.layers) {
    json["layers"] = layersJson(map.layers());
    json["disk_bytes"] = diskBytesOf(file);
  }
  if (!inputs.crs.empty()) json["crs"] = inputs.crs;
  const Eigen::Vector3d& origin = inputs.map_origin;
  if (!origin.isZero(0)) json["map_origin"] = {origin.x(), origin.y(), origin.z()};
  json["input_files"] = inputFilesJson(inputs);
  json["heights_by_class"] = heightsJson(figures->heights);
  json["runs"] = runsJson(figures->runs);
  printJson(json);
  return ExitCode::Done;
}

}  // namespace

void addInfo(CLI::App& app, Session& session) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command = app.add_subcommand("info", "show what scans or a map contain");
  command->add_option("input", options->inputs, "a map, or files, folders and manifests of scans")->required();
  addScanOptions(*command, options->scans);
  command->add_flag("--clouds", options->clouds, "list the clouds of a map, with their ids");
  command->add_flag("--layers", options->layers, "list the tables of a map with their bytes");
  addHtmlFile(*command, options->html);
  onRun(*command, session, [options, &session] {
    const auto map = std::find_if(options->inputs.begin(), options->inputs.end(), isMap);
    if (map == options->inputs.end()) return infoOfScans(*options, session);
    if (options->inputs.size() == 1) return infoOfMap(*options, *map, session);
    throw Error(ErrorKind::InvalidArgument,
                map->string() + ": is a map; give it alone, because a map and scans are not summarised together");
  });
}

}  // namespace cluxel::app
