// SPDX-License-Identifier: Apache-2.0
// The build's own oracle over a store with the map's ontology and operator statements.
#include "cluxel/mapping/ask_replay.hpp"

#include <optional>

#include "cluxel/knowledge/ontology.hpp"
#include "mapping/ask_oracle.hpp"
#include "mapping/operator_statements.hpp"
#include "mapping/semantic_layer.hpp"

namespace cluxel {

struct AskReplay::Impl {
  const MapReader& map;
  MapInputs inputs;
  std::vector<Cloud> clouds;
  std::vector<SemanticObject> objects;  ///< those so far
  std::shared_ptr<Environment> scratch;
  std::optional<WriteTransaction> transaction;
  std::optional<MapOracle> oracle;

  explicit Impl(const MapReader& map_) : map(map_) {}

  MapOracle& opened() {
    if (oracle) return *oracle;
    inputs = map.inputs();
    clouds = map.clouds();
    scratch = Environment::temporary();
    transaction.emplace(scratch->write());
    writeOntology(*transaction, inputs);
    copyOperatorStatements(map.quads(), *transaction);
    oracle.emplace(*transaction, [this](std::span<const SemanticObject> so_far) {
      writeObjectsSoFar(*transaction, inputs, clouds, map.scene(), map.stages(), so_far);
    });
    oracle->objectsSoFar(objects);
    return *oracle;
  }
};

AskReplay::AskReplay(const MapReader& map) : impl_(std::make_unique<Impl>(map)) {}
AskReplay::~AskReplay() = default;

bool AskReplay::ask(const std::string& query, const std::map<std::string, std::string>& bindings) {
  return impl_->opened().ask(query, bindings);
}

void AskReplay::objectsSoFar(std::span<const SemanticObject> objects) {
  impl_->objects.assign(objects.begin(), objects.end());
  if (impl_->oracle) impl_->oracle->objectsSoFar(objects);
}

}  // namespace cluxel
