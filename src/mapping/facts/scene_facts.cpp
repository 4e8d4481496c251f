// SPDX-License-Identifier: Apache-2.0
// One thread at a time uses the transaction.
#include "mapping/facts/scene_facts.hpp"

#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

SceneFacts::SceneFacts(rdf::WriteTransaction& transaction, const MapInputs& inputs, const std::vector<Cloud>& clouds,
                       const perception::Scene& scene)
    : transaction_(transaction), inputs_(inputs), clouds_(clouds), scene_(scene) {}

void SceneFacts::begin(std::shared_future<WayGraph> ways) {
  telling_ = std::async(std::launch::async, [this, ways = std::move(ways)] {
    ways.wait();
    tell();
    transaction_.writePages();  // so that the commit, which uses one thread, has fewer left
  });
}

void SceneFacts::wait() {
  if (telling_.valid()) telling_.get();
}

void SceneFacts::collect() {
  wait();
  if (!sink_) tell();
}

void SceneFacts::tell() {
  sink_.emplace(transaction_, rdf::vocabulary::kGraphObserved);
  addSceneFacts(inputs_, clouds_, scene_, *sink_);
  sink_->sortSoFar();
}

}  // namespace cluxel::mapping
