// SPDX-License-Identifier: Apache-2.0
// The facts about ways of a map that is changed in places.
#pragma once

#include "mapping/build/tile_stages.hpp"
#include "mapping/facts/fact_patch.hpp"
#include "mapping/facts/fact_sink.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/ways/ways.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Adds to `facts` and `patch` what makes the stored facts about ways those of `ways`. `stored`: the quads of the
/// transaction.
void replaceWayFacts(rdf::WriteTransaction& transaction, const WayGraph& ways, const rdf::QuadReader& stored,
                     FactSink& facts, FactPatch& patch);

/// Takes what gone things left in the ground out of the stored ways. To be called when objects, layers of tiles and
/// presence are written. Returns whether ways changed. Cost: that of updateFreedTiles(), and of the ways around tiles
/// that changed.
bool freeWays(rdf::WriteTransaction& transaction, const ParsedInputs& parsed, TileStages& stages, unsigned threads);

/// The same, and tells the ways that are others. To be called before inference.
void tellWaysWithoutGone(rdf::WriteTransaction& transaction, const ParsedInputs& parsed, TileStages& stages,
                         unsigned threads);

}  // namespace cluxel::mapping
