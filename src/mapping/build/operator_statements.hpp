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
/// Texts that do not depend on labels of blank nodes: one line per quad without blank nodes, one text per group of
/// quads that share blank nodes.
std::set<std::string> canonicalTextsOf(const std::vector<Quad>& quads);
/// Removes quads about blank nodes that repeat other such quads. Otherwise each repeated merge would add a copy.
void removeDuplicatesOfBlankNodes(rdf::WriteTransaction& transaction);
/// Leaves graph `operator` empty.
void clearOperatorStatements(rdf::WriteTransaction& transaction);

}  // namespace cluxel::mapping
