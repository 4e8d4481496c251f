// SPDX-License-Identifier: Apache-2.0
// Asks Cluxel and a second engine the same query and compares the answers.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rdf/file/environment.hpp"
#include "rdf/store/quad_store.hpp"
#include "sparql/query_engine.hpp"
#include "sparql/support/second_engine_fixture.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;

std::shared_ptr<Environment> storeOf(const std::vector<Quad>& quads);

/// The answer, or the error's text. `union_graph`: the default graph is the union of the graphs but the history.
EngineAnswer askCluxel(const QuadReader& reader, const std::string& text, bool union_graph,
                       const std::vector<Binding>& bindings = {});

/// Oxigraph gives a triple of a union once per graph that holds it; RDF's merge holds it once. So for queries over the
/// union it gets the merge as its unnamed graph.
std::vector<Quad> withUnionAsDefault(const std::vector<Quad>& quads);

/// Empty when both refuse or both give the same multiset of solutions; numbers are compared to ten digits.
std::string differenceOf(const EngineAnswer& ours, const EngineAnswer& theirs);

}  // namespace cluxel::test
