// SPDX-License-Identifier: Apache-2.0
// A small generated map for tests of the query engine: objects, parts, classes, numbers, strings, blank nodes, graphs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cluxel/term.hpp"

namespace cluxel::test {

inline constexpr const char* kMadeObject = "https://w3id.org/cluxel/map/object/";

/// The graphs of the map, the unnamed one ("") first.
std::vector<std::string> madeGraphs();

/// About 14 quads per object, the same for the same seed.
std::vector<Quad> madeMap(std::uint32_t seed, int objects);
/// A map with the vocabulary of built maps: objects with measures, parts, neighbours and observations in the graph
/// "observed".
std::vector<Quad> surveyedMap(std::uint32_t seed, int objects);

}  // namespace cluxel::test
