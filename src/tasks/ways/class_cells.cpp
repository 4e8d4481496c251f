// SPDX-License-Identifier: Apache-2.0
// Objects by their points, places and ways by what the map says of them.
#include "tasks/ways/class_cells.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"
#include "rdf/wkt_reader.hpp"
#include "sparql/query_engine.hpp"
#include "tasks/objects_of_class.hpp"

namespace cluxel::tasks {

namespace {

double numberIn(const sparql::ResultTable& table, std::size_t row, std::size_t column) {
  const Term* term = table.at(row, column);
  return term == nullptr ? std::nan("") : std::strtod(term->text.c_str(), nullptr);
}

std::string linesQuery(const std::string& class_iri) {
  return "PREFIX geo: <" + std::string(rdf::vocabulary::kGeo) + "> SELECT ?wkt { ?way a <" + class_iri +
         "> ; geo:hasGeometry/geo:asWKT ?wkt }";
}

/// The part of a line within the box: where it begins and ends, as shares of the line. Empty when it passes the box.
struct LinePart {
  double begin = 0, end = 1;
};
LinePart partWithin(const Eigen::AlignedBox2d& box, const Eigen::Vector2d& from, const Eigen::Vector2d& along) {
  LinePart part;
  for (int axis = 0; axis < 2; ++axis) {
    if (along[axis] == 0) {
      if (from[axis] < box.min()[axis] || from[axis] > box.max()[axis]) part.end = -1;
      continue;
    }
    const double low = (box.min()[axis] - from[axis]) / along[axis],
                 high = (box.max()[axis] - from[axis]) / along[axis];
    part.begin = std::max(part.begin, std::min(low, high));
    part.end = std::min(part.end, std::max(low, high));
  }
  return part;
}

/// Marks the cells along the lines of a geometry: a way is near wherever it runs. Cost: the cells that it crosses.
void markLines(const GridFrame& frame, std::string_view wkt, LargeArray<std::uint8_t>& marked) {
  const auto text = rdf::splitWkt(wkt);
  const auto shape = text ? rdf::readWkt(text->shape) : std::nullopt;
  if (!shape) return;
  const Eigen::Vector2d corner(frame.min_x, frame.min_y), size(frame.columns, frame.rows);
  const Eigen::AlignedBox2d grid(corner, corner + frame.cell_m * size);
  for (const rdf::WktPath& line : shape->lines)
    for (std::size_t i = 1; i < line.size(); ++i) {
      const Eigen::Vector2d from(line[i - 1].first, line[i - 1].second), to(line[i].first, line[i].second);
      const LinePart part = partWithin(grid, from, to - from);
      if (part.begin > part.end) continue;
      const double share = part.end - part.begin;
      const double steps = std::max(1.0, std::ceil(2 * share * (to - from).norm() / frame.cell_m));
      for (double step = 0; step <= steps; ++step)
        if (const auto cell = frame.cellAt(from + (part.begin + step / steps * share) * (to - from))) marked[*cell] = 1;
    }
}

}  // namespace

LargeArray<std::uint8_t> cellsWith(const mapping::MapReader& map, const TerrainGrid& terrain,
                                   const std::string& class_iri, const std::vector<bool>& is_left_out) {
  std::vector<bool> is_of_class(is_left_out.size(), false);
  for (const std::uint32_t object : objectsOfClass(map, class_iri)) is_of_class[object] = true;
  return cellsWith(map, terrain, class_iri, is_of_class, is_left_out);
}

LargeArray<std::uint8_t> cellsWith(const mapping::MapReader& map, const TerrainGrid& terrain,
                                   const std::string& class_iri, const std::vector<bool>& is_of_class,
                                   const std::vector<bool>& is_left_out) {
  LargeArray<std::uint8_t> marked(terrain.frame.size(), 0);
  for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell)
    for (const std::uint32_t thing : terrain.thingsIn(cell))
      if (thing != kUnnamedThing && is_of_class[thing] && !is_left_out[thing]) marked[cell] = 1;
  // A place stands where its members stand.
  const std::string query = "PREFIX clx: <" + std::string(rdf::vocabulary::kClx) + "> SELECT ?x ?y ?thing { ?o a <" +
                            class_iri +
                            "> . { ?o clx:x ?x ; clx:y ?y BIND(?o AS ?thing) } UNION "
                            "{ ?o clx:hasMember ?thing . ?thing clx:x ?x ; clx:y ?y } }";
  const sparql::ResultTable places = sparql::evaluateQuery(map.quads(), query).table;
  std::set<std::string> left_out;
  for (std::size_t i = 0; i < is_left_out.size(); ++i)
    if (is_left_out[i]) left_out.insert(rdf::iriOfObject(map.objectIds()[i]));
  for (std::size_t row = 0; row < places.row_count; ++row) {
    const auto cell = terrain.frame.cellAt({numberIn(places, row, 0), numberIn(places, row, 1)});
    if (cell && !left_out.contains(places.at(row, 2)->text)) marked[*cell] = 1;
  }
  const sparql::ResultTable lines = sparql::evaluateQuery(map.quads(), linesQuery(class_iri)).table;
  for (std::size_t row = 0; row < lines.row_count; ++row)
    if (const Term* wkt = lines.at(row, 0)) markLines(terrain.frame, wkt->text, marked);
  return marked;
}

}  // namespace cluxel::tasks
