// SPDX-License-Identifier: Apache-2.0
// The oracle of the build, over a temporary store with the map's ontology and operator statements.
#include "mapping/facts/ask_replay.hpp"

#include <optional>

#include "mapping/build/operator_statements.hpp"
#include "mapping/build/way_tiles.hpp"
#include "mapping/facts/map_oracle.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "rdf/ontology/ontology.hpp"

namespace cluxel::mapping {

struct AskReplay::Impl {
  const MapReader& map;
  MapInputs inputs;
  std::vector<Cloud> clouds;
  WayGraph ways;
  std::vector<rules::SemanticObject> objects;  ///< the objects decided so far
  std::shared_ptr<rdf::Environment> scratch;
  std::optional<rdf::WriteTransaction> transaction;
  std::optional<MapOracle> oracle;

  explicit Impl(const MapReader& map_) : map(map_) {}

  MapOracle& opened() {
    if (oracle) return *oracle;
    inputs = map.inputs();
    clouds = map.clouds();
    ways = map.measuredWays();
    scratch = rdf::Environment::temporary();
    transaction.emplace(scratch->write());
    writeOntology(*transaction, inputs);
    copyOperatorStatements(map.quads(), *transaction);
    oracle.emplace(*transaction, [this](std::span<const rules::SemanticObject> so_far) {
      writeObjectsSoFar(*transaction, inputs, clouds, map.scene(), map.stages(), ways, so_far);
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

void AskReplay::objectsSoFar(std::span<const rules::SemanticObject> objects) {
  impl_->objects.assign(objects.begin(), objects.end());
  if (impl_->oracle) impl_->oracle->objectsSoFar(objects);
}

}  // namespace cluxel::mapping
