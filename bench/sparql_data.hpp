// SPDX-License-Identifier: Apache-2.0
// A generated map for the comparison of query engines: objects, primitives, observations, clouds, an ontology.
#pragma once

#include <cstdint>
#include <functional>

#include "cluxel/term.hpp"

namespace cluxel::bench {

/// Hands out about `triples` distinct triples, the same ones for the same number; each in the graph it has in a map
/// (ontology, observed, inferred). The share of every kind of triple is the same at every size.
void generateMap(std::uint64_t triples, const std::function<void(const Quad&)>& take);

}  // namespace cluxel::bench
