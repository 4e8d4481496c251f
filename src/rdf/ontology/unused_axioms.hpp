// SPDX-License-Identifier: Apache-2.0
// Axioms of OWL that are kept as facts, but that inference does not use.
#pragma once

#include <map>
#include <span>
#include <string>

#include "rdf/io/rdf_io.hpp"

namespace cluxel::rdf {

/// How many statements use which axiom ("owl:equivalentClass"). Of an anonymous class ([ owl:onProperty … ]) the
/// property that makes it one counts. Throws InputError for faults of syntax.
std::map<std::string, std::size_t> unusedAxioms(std::span<const RdfSource> sources);

}  // namespace cluxel::rdf
