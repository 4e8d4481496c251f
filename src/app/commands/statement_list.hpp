// SPDX-License-Identifier: Apache-2.0
// Operator statements as text and JSON.
#pragma once

#include <string>
#include <vector>

#include "app/command.hpp"
#include "mapping/change/statement_change.hpp"

namespace cluxel::app {

/// "Tree" of the vocabulary, the IRI of another class.
std::string classText(const std::string& iri);
/// "4f0a… is clx:StreetSign: applied to …, the rules say clx:Lamp".
std::string lineOf(const mapping::StatementOutcome& outcome);
/// The same as an object, with the keys of printStatements() but for the author and the time.
Json jsonOf(const mapping::StatementOutcome& outcome);
/// One line, or one JSON object, for each statement.
void printStatements(const std::vector<mapping::KnownStatement>& statements, const Session& session);

}  // namespace cluxel::app
