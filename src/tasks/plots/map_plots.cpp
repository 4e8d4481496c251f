// SPDX-License-Identifier: Apache-2.0
// Heights and runs are read from the RDF, so that no scene need be assembled.
#include "tasks/plots/map_plots.hpp"

#include <charconv>
#include <unordered_map>

#include "rdf/map_iris.hpp"
#include "sparql/query_engine.hpp"
#include "tasks/changes/site_changes.hpp"

namespace cluxel::tasks {

namespace {

constexpr std::string_view kPlotPrefixes =
    "PREFIX clx: <https://w3id.org/cluxel/ontology#> PREFIX prov: <http://www.w3.org/ns/prov#> "
    "PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#> ";

sparql::ResultTable rowsOf(const mapping::MapReader& map, const std::string& query) {
  return sparql::evaluateQuery(map.quads(), std::string(kPlotPrefixes) + query).table;
}

std::string textOf(const sparql::ResultTable& table, std::size_t row, std::size_t column) {
  const Term* term = table.at(row, column);
  return term == nullptr ? std::string() : term->text;
}

double numberOf(const sparql::ResultTable& table, std::size_t row, std::size_t column) {
  const std::string text = textOf(table, row, column);
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::vector<PlotSpread> heightsByClass(const mapping::MapReader& map) {
  const sparql::ResultTable rows = rowsOf(map, "SELECT ?o ?height { ?o clx:confidence ?c ; clx:height ?height }");
  std::unordered_map<std::string, double> height_of;
  for (std::size_t i = 0; i < rows.row_count; ++i) height_of[textOf(rows, i, 0)] = numberOf(rows, i, 1);
  std::map<std::string, std::vector<double>> by_class;
  for (std::size_t i = 0; i < map.objectIds().size(); ++i) {
    const auto height = height_of.find(rdf::iriOfObject(map.objectIds()[i]));
    if (height != height_of.end()) by_class[map.classNames().nameOf(map.objectClasses()[i])].push_back(height->second);
  }
  std::vector<PlotSpread> spreads;
  for (auto& [name, values] : by_class) spreads.push_back(spreadOf(name, std::move(values)));
  return spreads;
}

std::vector<MapRun> runsOf(const mapping::MapReader& map) {
  const sparql::ResultTable rows =
      rowsOf(map,
             "SELECT ?run ?operation ?started ?ended (COUNT(DISTINCT ?scan) AS ?scans) { GRAPH "
             "<https://w3id.org/cluxel/graph/history> { ?run clx:operation ?operation ; prov:startedAtTime ?started ; "
             "prov:endedAtTime ?ended OPTIONAL { ?run prov:used ?scan } } } GROUP BY ?run ?operation ?started ?ended "
             "ORDER BY ?started ?run");
  const sparql::ResultTable stages =
      rowsOf(map,
             "SELECT ?run ?name ?seconds { GRAPH <https://w3id.org/cluxel/graph/history> { ?run clx:hasStage ?stage . "
             "?stage rdfs:label ?name ; clx:seconds ?seconds } } ORDER BY ?run STRLEN(STR(?stage)) ?stage");
  std::vector<MapRun> runs;
  std::unordered_map<std::string, std::size_t> number_of;
  for (std::size_t i = 0; i < rows.row_count; ++i) {
    number_of[textOf(rows, i, 0)] = runs.size();
    const std::string started = textOf(rows, i, 2);
    runs.push_back({textOf(rows, i, 1),
                    started,
                    timeNamed(textOf(rows, i, 3)) - timeNamed(started),
                    static_cast<std::uint64_t>(numberOf(rows, i, 4)),
                    {}});
  }
  for (std::size_t i = 0; i < stages.row_count; ++i)
    if (const auto run = number_of.find(textOf(stages, i, 0)); run != number_of.end())
      runs[run->second].stages.emplace_back(textOf(stages, i, 1), numberOf(stages, i, 2));
  return runs;
}

PlotFigure objectsFigure(const MapFigures& figures) {
  PlotFigure figure{"objects", "Objects by class", "Number of objects.",
                    "",        "Objects by class", {{"class", "objects"}, {}}};
  std::vector<PlotBar> bars;
  for (const auto& [name, count] : figures.summary.objects_by_class) {
    bars.push_back({name, static_cast<double>(count), std::to_string(count)});
    figure.table.rows.push_back({name, std::to_string(count)});
  }
  figure.svg = barChart(figure.title, bars);
  return figure;
}

PlotFigure heightsFigure(const MapFigures& figures) {
  PlotFigure figure{"heights",
                    "Heights by class",
                    "Heights of the boxes of objects in metres. Box: the middle half of the objects; line across it: "
                    "the median; line: from the smallest to the largest.",
                    spreadChart("Heights by class", "m", figures.heights),
                    "Heights in metres",
                    {{"class", "objects", "least", "lower quartile", "median", "upper quartile", "greatest"}, {}}};
  for (const PlotSpread& spread : figures.heights)
    figure.table.rows.push_back({spread.label, std::to_string(spread.count), plotNumber(spread.least),
                                 plotNumber(spread.lower), plotNumber(spread.middle), plotNumber(spread.upper),
                                 plotNumber(spread.most)});
  return figure;
}

/// The stages of all runs in one chart would mix builds with changes: each run has its own.
PlotFigure runFigure(const MapRun& run, std::size_t number) {
  const std::string name = run.operation + " of " + run.started;
  PlotFigure figure{"run-" + std::to_string(number),
                    "Time of " + name,
                    "The whole run took " + plotNumber(run.seconds) + " s, with " + std::to_string(run.scans) +
                        " scans. " +
                        (run.stages.empty() ? "The map does not hold the times of its stages." : "Seconds by stage."),
                    "",
                    "Seconds by stage of " + name,
                    {{"stage", "seconds"}, {}}};
  std::vector<PlotBar> bars;
  for (const auto& [stage, seconds] : run.stages) {
    bars.push_back({stage, seconds, plotNumber(seconds) + " s"});
    figure.table.rows.push_back({stage, plotNumber(seconds)});
  }
  if (!bars.empty()) figure.svg = barChart(figure.title, bars);
  return figure;
}

}  // namespace

MapFigures mapFigures(const mapping::MapReader& map) {
  return {map.summary(), heightsByClass(map), runsOf(map)};
}

PlotReport mapPlots(const MapFigures& figures, const std::string& name) {
  const mapping::MapSummary& summary = figures.summary;
  PlotReport report{"Map " + name,
                    {std::to_string(summary.clouds) + " scans, " + std::to_string(summary.points) + " points, " +
                     std::to_string(summary.objects) + " objects, " + std::to_string(summary.quads) + " quads"},
                    {objectsFigure(figures), heightsFigure(figures)}};
  if (!summary.is_finished) report.lines.emplace_back("The build of this map is not finished.");
  for (std::size_t i = 0; i < figures.runs.size(); ++i) report.figures.push_back(runFigure(figures.runs[i], i + 1));
  return report;
}

}  // namespace cluxel::tasks
