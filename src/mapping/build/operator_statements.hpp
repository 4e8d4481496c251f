// SPDX-License-Identifier: Apache-2.0
// Operator's statements, copied between stores.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "rdf/file/environment.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// Adds the quads of graph `operator` to `into`, flushes, and returns how many there are. Labels of blank nodes get
/// `blank_suffix`, which keeps those of several maps apart.
std::uint64_t copyOperatorStatements(const rdf::QuadReader& from, rdf::WriteTransaction& into,
                                     const std::string& blank_suffix = {});
/// Adds quads to graph `operator`, whatever their graph, and flushes.
void addOperatorStatements(rdf::WriteTransaction& transaction, const std::vector<Quad>& quads);
/// The quads of graph `operator`; labels of blank nodes get `blank_suffix`.
std::vector<Quad> operatorStatements(const rdf::QuadReader& reader, const std::string& blank_suffix = {});
/// What quads say, whatever the labels of blank nodes: a line for each quad without, and a text for all that is said of
/// blank nodes that belong together.
std::set<std::string> sayingsOf(const std::vector<Quad>& quads);
/// Leaves what is said of blank nodes once, if it is said several times: else a merge that is repeated would say it
/// again.
void removeRepeatedSayings(rdf::WriteTransaction& transaction);
/// Leaves graph `operator` empty.
void clearOperatorStatements(rdf::WriteTransaction& transaction);

}  // namespace cluxel::mapping
