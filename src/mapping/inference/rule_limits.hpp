// SPDX-License-Identifier: Apache-2.0
// Keeps rules from finding what rules have made only because they may look at everything.
#pragma once

#include <variant>
#include <vector>

#include "mapping/map_inputs.hpp"
#include "sparql/syntax/ast.hpp"

namespace cluxel::mapping {

/// Calls `visit` with the groups below an element, but for those of sub-selects and expressions.
template <typename Element, typename Visit>
void forEachGroup(Element& element, const Visit& visit) {
  if (auto* inner = std::get_if<sparql::ast::GroupPattern>(&element.value)) visit(*inner);
  if (auto* optional = std::get_if<sparql::ast::OptionalPattern>(&element.value)) visit(optional->group);
  if (auto* minus = std::get_if<sparql::ast::MinusPattern>(&element.value)) visit(minus->group);
  if (auto* graph = std::get_if<sparql::ast::GraphPattern>(&element.value)) visit(graph->group);
  if (auto* service = std::get_if<sparql::ast::ServicePattern>(&element.value)) visit(service->group);
  if (auto* either = std::get_if<sparql::ast::UnionPattern>(&element.value))
    for (auto& branch : either->branches) visit(branch);
}

bool hasExists(const sparql::ast::Expression& expression);

/// Whether a select or one below it has EXISTS outside of its patterns: in HAVING, GROUP BY, ORDER BY or what it
/// selects.
bool asksExists(const sparql::ast::Select& select);

/// Throws InputError for a path that may have no step between two variables that nothing else binds: it holds for every
/// term of the map, also for those by which derivations are described. `query`: with sequences of paths taken apart.
void refuseUnboundPaths(const sparql::ast::Query& query, const NamedText& rule);

/// Leaves out descriptions of derivations (clx:Derivation) where a pattern may hold for any fact: where its property is
/// a variable, or a path walks all properties but some. A rule would find what it made itself, without end.
void hideDerivations(sparql::ast::Query& query);

}  // namespace cluxel::mapping
