// SPDX-License-Identifier: Apache-2.0
// Multisets of tuples that are the same up to the names of blank nodes.
#pragma once

#include <optional>
#include <vector>

#include "cluxel/term.hpp"

namespace cluxel::test {

/// A row, triple or quad.
using Tuple = std::vector<std::optional<Term>>;

/// Whether a bijection of blank nodes turns the one multiset of tuples into the other. Numbers of one datatype are
/// compared by value. Thousands of alike blank nodes cost no more than others: the tuples are split where no blank node
/// ties them, and each part is compared by itself.
bool isomorphic(const std::vector<Tuple>& a, const std::vector<Tuple>& b);

}  // namespace cluxel::test
