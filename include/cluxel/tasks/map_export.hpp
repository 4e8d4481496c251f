// SPDX-License-Identifier: Apache-2.0
// A map in other people's formats: RDF, coloured clouds, footprints.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "cluxel/mapping/map_reader.hpp"

namespace cluxel {

enum class ExportFormat : std::uint8_t { Turtle, NQuads, Canonical, Ply, GeoJson };
/// By name or file ending: turtle ttl, nquads nq, canonical, ply, geojson.
std::optional<ExportFormat> exportFormatOf(std::string_view name);

using ByteSink = std::function<void(std::string_view)>;

/// Writes the map to `out`:
/// Turtle: the union of all graphs but history. NQuads: all graphs. Canonical: sorted N-Quads without history: equal
/// bytes mean equal maps. Ply: all points in the map frame [m] with the colour of their object's class, the object's
/// number (its place in GeoJson's list, -1: none), and the primitive label. GeoJson: footprints of objects, coordinates
/// in the map frame [m].
void exportMap(const MapReader& map, ExportFormat format, const ByteSink& out);

}  // namespace cluxel
