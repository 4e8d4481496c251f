// SPDX-License-Identifier: Apache-2.0
// Chooses the writer; RDF is written by module rdf.
#include "tasks/export/map_export.hpp"

#include <algorithm>

#include "rdf/io/rdf_io.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/export/cloud_export.hpp"
#include "tasks/export/footprint_export.hpp"

namespace cluxel::tasks {

std::optional<ExportFormat> exportFormatOf(std::string_view name) {
  if (name == "turtle" || name == "ttl") return ExportFormat::Turtle;
  if (name == "nquads" || name == "nq") return ExportFormat::NQuads;
  if (name == "canonical") return ExportFormat::Canonical;
  if (name == "ply") return ExportFormat::Ply;
  if (name == "geojson" || name == "json") return ExportFormat::GeoJson;
  return std::nullopt;
}

bool isRdf(ExportFormat format) {
  return format == ExportFormat::Turtle || format == ExportFormat::NQuads || format == ExportFormat::Canonical;
}

bool exportQuads(const rdf::QuadReader& quads, ExportFormat format, const ByteSink& out) {
  if (format == ExportFormat::Canonical)
    return writeCanonicalNQuads(quads, out,
                                [](const Term& graph) { return graph.text != rdf::vocabulary::kGraphHistory; });
  if (format == ExportFormat::Turtle)
    writeTurtle(quads, std::nullopt, out);
  else
    writeSortedNQuads(quads, out);
  return true;
}

bool exportMap(const mapping::MapReader& map, ExportFormat format, const ByteSink& out, ExportFrame frame) {
  if (isRdf(format)) return exportQuads(map.quads(), format, out);
  if (format == ExportFormat::Ply)
    writeColouredPly(map, out);
  else
    writeFootprints(map, frame, out);
  return true;
}

}  // namespace cluxel::tasks
