// SPDX-License-Identifier: Apache-2.0
// Writes what was decided about a scene into the layers of tiles and the records of objects.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "perception/segments/scene.hpp"
#include "perception/tile.hpp"
#include "rdf/file/environment.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

/// What a scene and the reasoning about it say of each tile. Numbers are those of the scene.
struct SceneLayers {
  const perception::Scene& scene;                           ///< as assembleScene() makes it
  const std::vector<rules::SemanticObject>& objects;        ///< sorted by id
  std::span<const std::uint64_t> traces = {}, inputs = {};  ///< by primitive; empty: all are 0
};

/// The block of one tile, and the objects that have a share of it, each once.
struct LayerBlock {
  std::string bytes;
  std::vector<ContentHash> objects;
};
using LayerBlocks = std::map<perception::TileKey, LayerBlock>;

/// The blocks of all tiles of the scene. They are a function of `layers`, whatever the number of threads.
LayerBlocks layerBlocks(const SceneLayers& layers, unsigned threads = 1);

/// Makes the map hold the layers of the scene of all its tiles, of which `blocks` are the blocks. Only blocks that
/// differ are written.
void storeLayers(rdf::WriteTransaction& transaction, const SceneLayers& layers, const LayerBlocks& blocks);
/// The same for `tiles` alone; the scene is that of a window around them. A tile that the scene lacks is removed. The
/// records of the objects in these tiles, before and after, follow; of an object that goes on outside of them, the
/// tiles there are kept, so an object that gets another name must lie in `tiles` as a whole.
void replaceLayers(rdf::WriteTransaction& transaction, const SceneLayers& layers, const perception::TileSet& tiles);

}  // namespace cluxel::mapping
