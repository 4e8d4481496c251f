// SPDX-License-Identifier: Apache-2.0
// The line of a quad in Turtle, which the parser does not tell.
#pragma once

#include <functional>

#include "rdf/io/rdf_io.hpp"

namespace cluxel::rdf {

/// As placeOf(), for Turtle and TriG: the line where the list of objects ends, by parsing ever better chosen beginnings
/// of the text. Line 0 for a text of more than 4 MiB, of which that would take seconds.
SourceLocation placeInSentences(const RdfSource& source, const std::function<bool(const Quad&)>& is_meant);

}  // namespace cluxel::rdf
