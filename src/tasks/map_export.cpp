// SPDX-License-Identifier: Apache-2.0
// Chooses the writer; RDF is written by module rdf.
#include "tasks/map_export.hpp"

#include <algorithm>

#include "rdf/io/rdf_io.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/cloud_export.hpp"
#include "tasks/footprint_export.hpp"

namespace cluxel::tasks {

std::optional<ExportFormat> exportFormatOf(std::string_view name) {
  if (name == "turtle" || name == "ttl") return ExportFormat::Turtle;
  if (name == "nquads" || name == "nq") return ExportFormat::NQuads;
  if (name == "canonical") return ExportFormat::Canonical;
  if (name == "ply") return ExportFormat::Ply;
  if (name == "geojson" || name == "json") return ExportFormat::GeoJson;
  return std::nullopt;
}

void exportMap(const mapping::MapReader& map, ExportFormat format, const ByteSink& out, ExportFrame frame) {
  switch (format) {
    case ExportFormat::Turtle:
      return writeTurtle(map.quads(), std::nullopt, out);
    case ExportFormat::NQuads:
      return writeSortedNQuads(map.quads(), out);
    case ExportFormat::Canonical:
      return writeSortedNQuads(map.quads(), out,
                               [](const Quad& quad) { return quad.graph.text != rdf::vocabulary::kGraphHistory; });
    case ExportFormat::Ply:
      return writeColouredPly(map, out);
    case ExportFormat::GeoJson:
      return writeFootprints(map, frame, out);
  }
}

}  // namespace cluxel::tasks
