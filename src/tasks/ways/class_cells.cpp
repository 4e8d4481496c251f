// SPDX-License-Identifier: Apache-2.0
// Objects by their points, places and ways by what the map says of them.
#include "tasks/ways/class_cells.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"
#include "rdf/wkt_reader.hpp"
#include "sparql/query_engine.hpp"

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

/// Marks the cells along the lines of a geometry: a way is near wherever it runs.
void markLines(const GridFrame& frame, std::string_view wkt, std::vector<std::uint8_t>& marked) {
  const auto text = rdf::splitWkt(wkt);
  const auto shape = text ? rdf::readWkt(text->shape) : std::nullopt;
  if (!shape) return;
  for (const rdf::WktPath& line : shape->lines)
    for (std::size_t i = 1; i < line.size(); ++i) {
      const Eigen::Vector2d from(line[i - 1].first, line[i - 1].second), to(line[i].first, line[i].second);
      const double steps = std::max(1.0, std::ceil(2 * (to - from).norm() / frame.cell_m));
      for (double step = 0; step <= steps; ++step)
        if (const auto cell = frame.cellAt(from + step / steps * (to - from))) marked[*cell] = 1;
    }
}

}  // namespace

std::vector<std::uint8_t> cellsWith(const mapping::MapReader& map, const TerrainGrid& terrain,
                                    const rdf::OntologyView& ontology, const std::string& class_iri,
                                    const std::vector<bool>& is_left_out) {
  std::vector<std::uint8_t> marked(terrain.frame.size(), 0);
  for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell)
    for (const std::uint32_t thing : terrain.thingsIn(cell))
      if (thing != kUnnamedThing && !is_left_out[thing] && ontology.isA(map.objects()[thing].class_iri, class_iri))
        marked[cell] = 1;
  // A place stands where its members stand.
  const std::string query = "PREFIX clx: <" + std::string(rdf::vocabulary::kClx) + "> SELECT ?x ?y ?thing { ?o a <" +
                            class_iri +
                            "> . { ?o clx:x ?x ; clx:y ?y BIND(?o AS ?thing) } UNION "
                            "{ ?o clx:hasMember ?thing . ?thing clx:x ?x ; clx:y ?y } }";
  const sparql::ResultTable places = sparql::evaluateQuery(map.quads(), query).table;
  std::set<std::string> left_out;
  for (std::size_t i = 0; i < is_left_out.size(); ++i)
    if (is_left_out[i]) left_out.insert(rdf::iriOfObject(map.objects()[i].id));
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
