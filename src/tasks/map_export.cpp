// SPDX-License-Identifier: Apache-2.0
// Chooses the writer; RDF goes through the knowledge wing.
#include "cluxel/tasks/map_export.hpp"

#include <algorithm>

#include "cluxel/knowledge/rdf_io.hpp"
#include "cluxel/knowledge/vocabulary.hpp"
#include "tasks/cloud_export.hpp"
#include "tasks/footprint_export.hpp"

namespace cluxel {

std::optional<ExportFormat> exportFormatOf(std::string_view name) {
  if (name == "turtle" || name == "ttl") return ExportFormat::Turtle;
  if (name == "nquads" || name == "nq") return ExportFormat::NQuads;
  if (name == "canonical") return ExportFormat::Canonical;
  if (name == "ply") return ExportFormat::Ply;
  if (name == "geojson" || name == "json") return ExportFormat::GeoJson;
  return std::nullopt;
}

void exportMap(const MapReader& map, ExportFormat format, const ByteSink& out) {
  switch (format) {
    case ExportFormat::Turtle:
      return writeTurtle(map.quads(), std::nullopt, out);
    case ExportFormat::NQuads:
      return writeSortedNQuads(map.quads(), out);
    case ExportFormat::Canonical:
      return writeSortedNQuads(map.quads(), out,
                               [](const Quad& quad) { return quad.graph.text != vocabulary::kGraphHistory; });
    case ExportFormat::Ply:
      return writeColouredPly(map, out);
    case ExportFormat::GeoJson:
      return writeFootprints(map, out);
  }
}

}  // namespace cluxel
