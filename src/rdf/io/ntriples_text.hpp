// SPDX-License-Identifier: Apache-2.0
// The N-Triples form of a term, without a copy of the term.
#pragma once

#include <string>

#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// Appends what toNTriples() gives.
void appendNTriples(std::string& out, const TermView& term);

}  // namespace cluxel::rdf
