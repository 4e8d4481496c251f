// SPDX-License-Identifier: Apache-2.0
// The IRIs of a map's resources. All but the root and the ground patches are named by a content hash, in hexadecimal.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/content_hash.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

/// `https://w3id.org/cluxel/map/<kind>/<name>`.
inline std::string mapIri(std::string_view kind, std::string_view name) {
  return std::string(vocabulary::kMap).append(kind).append("/").append(name);
}

inline std::string iriOfMapRoot() {
  return mapIri("map", "root");
}
/// `scan` is the hash of what the scan measured.
inline std::string iriOfCloud(const ContentHash& scan) {
  return mapIri("cloud", scan.hex());
}
inline std::string iriOfPrimitive(const ContentHash& id) {
  return mapIri("primitive", id.hex());
}
inline std::string iriOfObject(const ContentHash& id) {
  return mapIri("object", id.hex());
}
inline std::string iriOfPart(const ContentHash& id) {
  return mapIri("part", id.hex());
}
inline std::string iriOfObservation(const ContentHash& id) {
  return mapIri("observation", id.hex());
}
/// Of one fact that a SPARQL rule derived.
inline std::string iriOfDerivation(const ContentHash& id) {
  return mapIri("derivation", id.hex());
}
/// What an operator stated.
inline std::string iriOfStatement(const ContentHash& id) {
  return mapIri("statement", id.hex());
}
/// The identity that stays while its object gains and loses members.
inline std::string iriOfThing(const ContentHash& id) {
  return mapIri("thing", id.hex());
}
/// Of one build of the map.
inline std::string iriOfActivity(const ContentHash& id) {
  return mapIri("activity", id.hex());
}
/// The ground below tile (x, y).
inline std::string iriOfGroundPatch(std::int32_t tile_x, std::int32_t tile_y) {
  return mapIri("ground", std::to_string(tile_x) + "_" + std::to_string(tile_y));
}

}  // namespace cluxel::rdf
