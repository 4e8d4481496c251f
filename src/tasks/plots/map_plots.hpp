// SPDX-License-Identifier: Apache-2.0
// The figures of a map: objects and heights by class, and how long its builds and changes took.
#pragma once

#include "mapping/map_reader.hpp"
#include "tasks/plots/plot_charts.hpp"
#include "tasks/plots/plot_page.hpp"

namespace cluxel::tasks {

/// A run that changed the map, as the history holds it.
struct MapRun {
  std::string operation, started;  ///< started: xsd:dateTime
  double seconds = 0;              ///< from start to end
  std::uint64_t scans = 0;
  std::vector<std::pair<std::string, double>> stages;  ///< seconds by stage; empty in maps of older programs
};

struct MapFigures {
  mapping::MapSummary summary;
  std::vector<PlotSpread> heights;  ///< of the boxes of objects [m], by class
  std::vector<MapRun> runs;         ///< by start
};

MapFigures mapFigures(const mapping::MapReader& map);
/// `name` of the map, for the title.
PlotReport mapPlots(const MapFigures& figures, const std::string& name);

}  // namespace cluxel::tasks
