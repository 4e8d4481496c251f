// SPDX-License-Identifier: Apache-2.0
// Sources of queries (a map, or an RDF file in a temporary store), and the shipped questions.
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/installation/data_home.hpp"
#include "rdf/store/quad_store.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::tasks {

struct QuerySource {
  std::shared_ptr<rdf::Environment> environment;
  sparql::DefaultGraph default_graph = sparql::DefaultGraph::UnionButHistory;

  rdf::QuadReader reader() const { return rdf::QuadReader(environment->read()); }
};

/// Opens a map, or loads an RDF file (.ttl .nt .nq .trig .rdf) into a temporary store.
QuerySource openQuerySource(const std::filesystem::path& file);

/// A column of the result, as a shipped question describes it.
struct QueryColumn {
  std::string name, unit, help;
};

/// A parameter of a question: a variable that is bound before the query runs.
struct QueryParameter {
  std::string name, unit, default_value, help;
  double min = -std::numeric_limits<double>::infinity(), max = std::numeric_limits<double>::infinity();
};

/// A shipped question: the header of a file in queries/ (`#!` lines) and its text.
struct Question {
  std::filesystem::path file;
  std::string title;  ///< in English
  std::vector<QueryParameter> parameters;
  std::vector<QueryColumn> columns;
  std::string text;
};

/// Reads the header: `#! title: …`, `#! column: name [unit] help`, `#! parameter: name [unit] = default help`. Behind
/// the default of a number may stand its range, `(from 0)` or `(from 0 to 1)`. Throws InputError for a line that cannot
/// be read. A file without a header is a question without a title.
Question readQuestion(const std::filesystem::path& file);
/// All questions in queries/, by file name.
std::vector<Question> shippedQuestions(const DataHome& home);
/// Values for all parameters of a question: the given ones (`name=value`) or the defaults. Throws Error
/// (InvalidArgument) for an unknown name, and for a value that is no number in the range where one is expected. Numbers
/// become xsd:decimal, `<iri>` an IRI, prefix:name a name of the ontology, else a string.
std::vector<sparql::Binding> bindingsFor(const Question& question, const std::vector<std::string>& given);

}  // namespace cluxel::tasks
