// SPDX-License-Identifier: Apache-2.0
// Operator's statements, copied between stores.
#pragma once

#include <cstdint>

#include "rdf/store/environment.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// Adds the quads of graph `operator` to `into`, flushes, and returns how many there are.
std::uint64_t copyOperatorStatements(const rdf::QuadReader& from, rdf::WriteTransaction& into);
/// Leaves graph `operator` empty.
void clearOperatorStatements(rdf::WriteTransaction& transaction);

}  // namespace cluxel::mapping
