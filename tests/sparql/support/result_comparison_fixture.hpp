// SPDX-License-Identifier: Apache-2.0
// Compares two answers up to the names of blank nodes.
#pragma once

#include <string>
#include <vector>

#include "sparql/results/result_table.hpp"
#include "sparql/support/isomorphism_fixture.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;

/// isomorphic() with the order of tuples kept.
bool isomorphicInOrder(const std::vector<Tuple>& a, const std::vector<Tuple>& b);

enum class RowOrder { Any, AsWritten };
enum class Cardinality { Exact, Reduced };  ///< Reduced: `actual` may hold fewer copies of a row, but at least one

/// Empty when the answers are equal, else a description of the differences.
std::string difference(const QueryResult& actual, const QueryResult& expected, RowOrder order = RowOrder::Any,
                       Cardinality cardinality = Cardinality::Exact);
std::string graphDifference(const std::vector<Quad>& actual, const std::vector<Quad>& expected);

}  // namespace cluxel::test
