// SPDX-License-Identifier: Apache-2.0
// Matches as librdf's streams and iterators.
#pragma once

#include <librdf.h>

#include <exception>
#include <vector>

#include "knowledge/redland_map.hpp"
#include "knowledge/redland_nodes.hpp"

namespace cluxel {

/// Tells the world's logger; exceptions must not reach librdf's C.
void logFailure(librdf_world* world, const std::exception& error);

/// Runs `work` for librdf: what it gives, or `otherwise` after telling the logger.
template <typename Result, typename Work>
Result guarded(librdf_world* world, Result otherwise, const Work& work) {
  try {
    return work();
  } catch (const std::exception& error) {
    logFailure(world, error);
    return otherwise;
  }
}

librdf_stream* streamOf(librdf_world* world, librdf_storage* storage, std::unique_ptr<RedlandMatches> matches);
librdf_iterator* iteratorOf(librdf_world* world, librdf_storage* storage, std::vector<Term> nodes);

}  // namespace cluxel
