// SPDX-License-Identifier: Apache-2.0
// What people stated about a map, taken over into another store.
#pragma once

#include <cstdint>

#include "cluxel/knowledge/environment.hpp"
#include "cluxel/knowledge/quad_store.hpp"

namespace cluxel {

/// Adds the quads of graph `operator` to `into`, flushes, and returns how many there are.
std::uint64_t copyOperatorStatements(const QuadReader& from, WriteTransaction& into);
/// Leaves graph `operator` empty.
void clearOperatorStatements(WriteTransaction& transaction);

}  // namespace cluxel
