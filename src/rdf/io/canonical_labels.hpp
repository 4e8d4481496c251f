// SPDX-License-Identifier: Apache-2.0
// Labels of blank nodes that follow from what is said about them alone: the algorithm of RDF Dataset Canonicalization
// (RDFC-1.0, https://www.w3.org/TR/rdf-canon/).
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "cluxel/term.hpp"

namespace cluxel::rdf {

/// By label, the canonical label ("c14n0") of each blank node in `quads`, which are all that name blank nodes, without
/// duplicates. Datasets that differ only by labels get the same quads. Blank nodes that are alike and point at each
/// other have to be tried in all orders: after `max_calls` tries, or in chains of more than a thousand, the result is
/// empty. Cost: a
/// few hashes a quad where what is said about the nodes differs.
std::map<std::string, std::string> canonicalLabels(const std::vector<Quad>& quads, std::size_t max_calls = 100'000);

}  // namespace cluxel::rdf
