// SPDX-License-Identifier: Apache-2.0
// Writes results in the W3C formats of SPARQL 1.1, as a text table, and graphs as Turtle or N-Triples.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sparql/results/result_table.hpp"

namespace cluxel::sparql {

enum class ResultFormat : std::uint8_t { Json, Xml, Csv, Tsv, Table, Turtle, NTriples };

/// The format of a name, file extension or media type: "json", "srj", "application/sparql-results+json", "ttl", …
std::optional<ResultFormat> resultFormatOf(std::string_view name);

struct WriterOptions {
  /// Prefixes that shorten IRIs in tables and Turtle: {"clx", "https://…#"}. If empty, the prefixes of Cluxel's
  /// vocabulary.
  std::vector<std::pair<std::string, std::string>> prefixes = {};
};

/// Receives consecutive chunks of text; exceptions propagate through the writer.
using TextSink = std::function<void(std::string_view)>;

/// A sink that writes one result to `out` in chunks of about 64 KiB. Solution formats write a graph as a table of
/// subject, predicate and object; writing solutions or a boolean as Turtle or N-Triples throws Error (InvalidArgument).
std::unique_ptr<ResultSink> makeResultWriter(ResultFormat format, TextSink out, const WriterOptions& options = {});

}  // namespace cluxel::sparql
