// SPDX-License-Identifier: Apache-2.0
// Whether objects that the map holds are there no more.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/map_reader.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::tasks {

/// When the first scan saw through the place of an object after it was gone (clx:seenThrough), as an xsd:dateTime.
/// Absent when no later scan shows it to be gone. Only graph `observed` counts: a rule or an update may state the
/// property in another graph, but no ray speaks for that.
std::optional<std::string> seenThrough(const rdf::QuadReader& quads, const std::string& object_iri);

/// Per object: whether seenThrough() tells a time.
std::vector<bool> goneAmong(const mapping::MapReader& map);

}  // namespace cluxel::tasks
