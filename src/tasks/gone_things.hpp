// SPDX-License-Identifier: Apache-2.0
// Whether an object that the map holds is there no more.
#pragma once

#include <optional>
#include <string>

#include "rdf/store/quad_store.hpp"

namespace cluxel::tasks {

/// When the first scan saw through the place of an object after it was gone (clx:seenThrough), as an xsd:dateTime.
/// Absent when no later scan shows it to be gone.
std::optional<std::string> seenThrough(const rdf::QuadReader& quads, const std::string& object_iri);

}  // namespace cluxel::tasks
