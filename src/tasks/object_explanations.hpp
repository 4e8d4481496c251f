// SPDX-License-Identifier: Apache-2.0
// The explanations of all objects of a map: memory follows a region, not the map.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "mapping/map_reader.hpp"

namespace cluxel::tasks {

/// How much of a map is explained together.
struct ExplainedCluxels {
  std::size_t whole = 500'000;   ///< a map of so many is explained at once
  std::size_t region = 500'000;  ///< of a larger map
};

/// Visits a line of JSON for each object, in the order of MapReader::objects(). Of a map with more cluxels than
/// `most.whole` the objects of a region are explained by a run over the region and what lies around it. Such a run
/// counts as it does for explainThing(). Objects for which none counts are explained by a run over the whole map; so is
/// every map with rules that ask it. The lines are those of explainObjects(), but for counterfactuals, which may follow
/// from the region. They wait in a temporary file. Throws Error (StoreUnavailable) for a damaged map, and when there is
/// no room for that file.
void forEachExplanation(const mapping::MapReader& map, const std::function<void(std::string_view)>& visit,
                        const ExplainedCluxels& most = {});

}  // namespace cluxel::tasks
