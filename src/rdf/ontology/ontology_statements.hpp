// SPDX-License-Identifier: Apache-2.0
// The statements of ontology files before they are stored, and the faults that are found in them.
#pragma once

#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/error.hpp"
#include "rdf/io/rdf_io.hpp"

namespace cluxel::rdf {

/// A statement and its source.
struct OntologyStatement {
  Quad quad;
  std::size_t source = 0;
};

/// Collects the statements of all sources and their faults, each with its place in the text.
class OntologyStatements {
 public:
  /// Throws one InputError with all faults of syntax.
  explicit OntologyStatements(std::span<const RdfSource> sources);

  const std::vector<OntologyStatement>& all() const { return statements_; }
  bool isClass(const Term& name) const { return name.kind == TermKind::Iri && classes_.contains(name.text); }
  /// The IRIs that are declared as classes.
  const std::set<std::string>& classes() const { return classes_; }

  /// Adds a fault of the statement's subject. It is shown at `word`, else at the object of the statement.
  void fault(const OntologyStatement& statement, const std::string& message, std::string hint = {},
             std::string_view word = {});
  /// Adds the fault that the object of the statement is no class.
  void faultOfClass(const OntologyStatement& statement);
  /// Throws one InputError when there are faults.
  void requireNone() const;

 private:
  std::span<const RdfSource> sources_;
  std::vector<OntologyStatement> statements_;
  std::vector<Diagnostic> faults_;
  std::set<std::string> classes_;
};

/// "did you mean 'Plant'?" for the nearest of these IRIs in the same namespace; else "did you mean <…#Plant>?" for one
/// that differs in the namespace alone; else "".
std::string similarNameHint(std::string_view iri, const std::set<std::string>& known);

/// Adds the faults for which an ontology is refused wherever it comes from.
void checkOntologyBasics(OntologyStatements& ontology);

}  // namespace cluxel::rdf
