// SPDX-License-Identifier: Apache-2.0
// A small store loaded from Turtle, with short functions for queries.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "rdf/file/environment.hpp"
#include "rdf/store/quad_store.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;

/// Turtle with the prefixes : (http://example.org/), clx:, xsd:, rdf:, rdfs:, geo: loaded into the unnamed graph.
class SmallStore {
 public:
  explicit SmallStore(std::string_view turtle = "");
  /// Adds Turtle to a graph.
  void load(std::string_view turtle, const std::string& graph_iri);
  void load(const std::vector<Quad>& quads);
  QuadReader reader() const { return QuadReader(environment_->read()); }
  const std::shared_ptr<Environment>& environment() const { return environment_; }

  QueryResult ask(std::string_view query, const QueryOptions& options = {}) const;
  /// The rows as text, sorted: "a b" with terms in N-Triples form, IRIs of the default namespace as ":name", "-" for
  /// unbound.
  std::vector<std::string> rows(std::string_view query, const QueryOptions& options = {}) const;
  /// The rows in the order given.
  std::vector<std::string> ordered(std::string_view query, const QueryOptions& options = {}) const;
  /// The value of an expression, in that form.
  std::string value(const std::string& expression) const;

 private:
  std::shared_ptr<Environment> environment_;
};

/// Runs the query and returns its plan with estimated and actual row counts.
std::string explainQuery(const QuadReader& reader, std::string_view text, const QueryOptions& options = {});

/// The prefixes above as SPARQL.
extern const std::string kPrefixes;

}  // namespace cluxel::test
