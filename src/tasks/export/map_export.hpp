// SPDX-License-Identifier: Apache-2.0
// A map in other formats: RDF, coloured clouds, footprints.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "mapping/map_reader.hpp"

namespace cluxel::tasks {

enum class ExportFormat : std::uint8_t { Turtle, NQuads, Canonical, Ply, GeoJson };
/// By name or file ending: turtle ttl, nquads nq, canonical, ply, geojson.
std::optional<ExportFormat> exportFormatOf(std::string_view name);

/// The coordinates of GeoJson.
enum class ExportFrame : std::uint8_t {
  LongitudeLatitude,  ///< WGS 84 [deg]
  Local,              ///< the map frame [m]; viewers that expect degrees show it in the wrong place
};

using ByteSink = std::function<void(std::string_view)>;

/// Writes the map to `out`:
/// Turtle: the union of all graphs but history. NQuads: all graphs. Canonical: sorted N-Quads without history, with
/// canonical labels of blank nodes; equal bytes mean equal maps. Ply: all points in the map frame [m] with the colour
/// of their object's class, and as scalar fields the object's number (its place in objects(), -1: none) and the
/// primitive label. GeoJson: one footprint per object in `frame`; throws Error (Remedy::LocalFrame) when the map cannot
/// be placed on the earth. False for Canonical when blank nodes are too much alike for canonical labels, so that equal
/// maps may have other bytes.
bool exportMap(const mapping::MapReader& map, ExportFormat format, const ByteSink& out,
               ExportFrame frame = ExportFrame::LongitudeLatitude);

/// Turtle, NQuads and Canonical need no more than quads.
bool isRdf(ExportFormat format);
/// As exportMap(), in one of these formats, also for a store that no build has made.
bool exportQuads(const rdf::QuadReader& quads, ExportFormat format, const ByteSink& out);

}  // namespace cluxel::tasks
