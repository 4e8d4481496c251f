// SPDX-License-Identifier: Apache-2.0
// Equality of multisets of tuples up to the names of blank nodes.
#pragma once

#include <optional>
#include <vector>

#include "cluxel/term.hpp"

namespace cluxel::test {

/// A row, triple or quad.
using Tuple = std::vector<std::optional<Term>>;

/// True when a bijection of blank nodes maps one multiset of tuples to the other. Numbers of one datatype are compared
/// by value. Connected parts are compared separately, so thousands of similar blank nodes are cheap.
bool isomorphic(const std::vector<Tuple>& a, const std::vector<Tuple>& b);

}  // namespace cluxel::test
