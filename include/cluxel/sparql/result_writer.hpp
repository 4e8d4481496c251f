// SPDX-License-Identifier: Apache-2.0
// Writes answers: the W3C formats of SPARQL 1.1 results, a table for people, and Turtle or N-Triples for graphs.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cluxel/sparql/result_table.hpp"

namespace cluxel {

enum class ResultFormat : std::uint8_t { Json, Xml, Csv, Tsv, Table, Turtle, NTriples };

/// By name, suffix or media type: "json", "srj", "application/sparql-results+json", "ttl", …
std::optional<ResultFormat> resultFormatOf(std::string_view name);
std::string_view mediaTypeOf(ResultFormat format);

struct WriterOptions {
  /// Shortens IRIs in tables and Turtle: {"clx", "https://…#"}. Empty: the prefixes of Cluxel's vocabulary.
  std::vector<std::pair<std::string, std::string>> prefixes = {};
};

/// Takes the pieces of a text in order; what it throws passes through the writer.
using TextSink = std::function<void(std::string_view)>;

/// A sink that writes one answer to `out` in pieces of about 64 KiB. A graph goes into a solution format as a table of
/// subject, predicate and object; solutions or a boolean into Turtle or N-Triples are an Error (Usage).
std::unique_ptr<ResultSink> makeResultWriter(ResultFormat format, TextSink out, const WriterOptions& options = {});

/// The whole text of a kept answer.
std::string writtenResult(const QueryResult& result, ResultFormat format, const WriterOptions& options = {});

}  // namespace cluxel
