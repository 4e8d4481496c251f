// SPDX-License-Identifier: Apache-2.0
// Who made and withdrew statements, and when. It stands in graph `history`.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "mapping/statements/statement.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// Adds a statement, and returns whether it was not there. What the history knew of an earlier one with the same
/// content is forgotten.
bool addStatement(rdf::WriteTransaction& transaction, const Statement& statement, const std::string& author);
/// Removes a statement, and records when. Returns false for one that was withdrawn before. Throws Error (NotFound) for
/// one that never was there.
bool withdrawStatement(rdf::WriteTransaction& transaction, const ContentHash& id, const std::string& author);
/// Removes statements of which the history tells when they were withdrawn, or will be told.
void eraseStatements(rdf::WriteTransaction& transaction, std::span<const ContentHash> ids);

/// Records statements that quads of graph `operator` made or withdrew. `author` may be empty.
void recordStatements(rdf::WriteTransaction& transaction, const std::vector<ContentHash>& made,
                      const std::vector<ContentHash>& withdrawn, const std::string& author);

/// Adds what the history of another map knows of its statements, and of those that were withdrawn there.
void copyStatementHistory(const rdf::QuadReader& from, rdf::WriteTransaction& into);

/// Those statements of maps that one of the maps has withdrawn after any of them made it, ascending. A statement whose
/// time nobody recorded was made before every withdrawal. Its result is independent of the order of the maps.
std::vector<ContentHash> withdrawnAmong(std::span<const rdf::QuadReader* const> maps);

/// The statements that were withdrawn and not made again, by id.
std::vector<ContentHash> withdrawnStatements(const rdf::QuadReader& quads);

/// What the history of a map knows of a statement.
struct StatementRecord {
  std::string author;     ///< all of them, when the history of several maps names several
  std::string stated_at;  ///< the last time; xsd:dateTime
};
StatementRecord recordOf(const rdf::QuadReader& quads, const ContentHash& id);

}  // namespace cluxel::mapping
