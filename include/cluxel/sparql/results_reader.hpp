// SPDX-License-Identifier: Apache-2.0
// Reads answers that were written in the W3C formats: for comparing engines, and for round trips.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cluxel/sparql/result_table.hpp"
#include "cluxel/sparql/result_writer.hpp"

namespace cluxel {

/// Json, Xml, Csv or Tsv. CSV does not tell terms apart: its cells become blank nodes (`_:x`) or plain literals, empty
/// ones unbound. Throws InputError with the place of a fault; Error (Usage) for other formats.
QueryResult readResults(std::string_view text, ResultFormat format, const std::string& file = "results");

/// An answer in the result set vocabulary of the test suites (rs:ResultSet, rs:solution, …). Throws InputError when
/// `graph` holds none.
QueryResult resultsFromGraph(const std::vector<Quad>& graph, const std::string& file = "results");

}  // namespace cluxel
