// SPDX-License-Identifier: Apache-2.0
// Opens the queries and files that a command line names for SPARQL commands.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "app/command.hpp"
#include "tasks/query_source.hpp"

namespace cluxel::app {

/// The query in a file (by path, or by name in queries/) or in a text; Error (InvalidArgument) for none or both.
tasks::Question questionFrom(const fs::path& file, const std::string& text, const Session& session);

/// `IRI=FILE` texts of an option; Error (InvalidArgument) for a text of another form.
std::map<std::string, fs::path> namedFiles(const std::string& option, const std::vector<std::string>& texts);

/// The same, each opened: a map, or an RDF file in a store of its own.
class NamedSources {
 public:
  NamedSources(const std::string& option, const std::vector<std::string>& texts);
  /// Valid for the lifetime of this object.
  std::map<std::string, const rdf::QuadReader*> readers() const;

 private:
  std::vector<tasks::QuerySource> sources_;
  std::map<std::string, rdf::QuadReader> readers_;
};

}  // namespace cluxel::app
