// SPDX-License-Identifier: Apache-2.0
// Exposes matches as librdf streams and iterators.
#pragma once

#include <librdf.h>

#include <exception>
#include <vector>

#include "rdf/redland/redland_map.hpp"
#include "rdf/redland/redland_nodes.hpp"

namespace cluxel::rdf {

/// Reports to the world's logger, because exceptions must not propagate into librdf's C code.
void logFailure(librdf_world* world, const std::exception& error);

/// Runs `work` and returns its result; logs an exception and returns `otherwise`.
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

}  // namespace cluxel::rdf
