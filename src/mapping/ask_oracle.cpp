// SPDX-License-Identifier: Apache-2.0
// Facts are written only when a rule asks; each query is planned once per state.
#include "mapping/ask_oracle.hpp"

namespace cluxel {

void MapOracle::objectsSoFar(std::span<const SemanticObject> objects) {
  objects_.assign(objects.begin(), objects.end());
  prepared_.clear();
  reader_.reset();
}

void MapOracle::bringUpToDate() {
  if (reader_) return;
  publish_(objects_);
  reader_.emplace(static_cast<const ReadTransaction&>(transaction_));
}

bool MapOracle::ask(const std::string& query, const std::map<std::string, std::string>& bindings) {
  bringUpToDate();
  std::vector<std::string> names;
  std::vector<Binding> values;
  for (const auto& [name, iri] : bindings) {
    names.push_back(name);
    values.emplace_back(name, Term::iri(iri));
  }
  auto prepared = prepared_.find(query);
  if (prepared == prepared_.end()) {
    QueryOptions options;
    options.refuse_volatile = true;
    options.source_name = "ask";
    prepared = prepared_.emplace(query, PreparedQuery(*reader_, query, options, names)).first;
  }
  return prepared->second.ask(values);
}

}  // namespace cluxel
