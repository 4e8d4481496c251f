// SPDX-License-Identifier: Apache-2.0
// The interface between reasoning and SPARQL: how `ask:` tests are checked and answered. The mapping module implements
// it.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace cluxel::rules {

struct SemanticObject;

/// What is wrong with a query; `offset` counts bytes in its text.
struct QueryFault {
  std::size_t offset = 0;
  std::string message;
};

/// Checks a query while rules are loaded, without a map; absent when there is no fault. `bound`: the variables that get
/// a value before it is asked.
using QueryCheck =
    std::function<std::optional<QueryFault>(const std::string& query, const std::vector<std::string>& bound)>;

/// The IRIs of the classes of which a query without fault looks for things (`?x a clx:Tree`).
using QueryClasses = std::function<std::vector<std::string>(const std::string& query)>;

/// Answers the `ask:` tests from the map and the ontology. The reasoning stage calls it from one thread.
class AskOracle {
 public:
  virtual ~AskOracle() = default;
  /// Whether the ASK query holds with its variables bound to the IRIs of these primitives. `query` has its prefixes.
  /// Throws InputError for a faulty query.
  virtual bool ask(const std::string& query, const std::map<std::string, std::string>& bindings) = 0;
  /// The objects of all classes decided so far. Later queries see these and no others.
  virtual void objectsSoFar(std::span<const SemanticObject> /*objects*/) {}
};

}  // namespace cluxel::rules
