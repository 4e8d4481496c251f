// SPDX-License-Identifier: Apache-2.0
// What follows from a scene alone, collected while its objects are decided.
#pragma once

#include <future>
#include <optional>
#include <vector>

#include "mapping/facts/fact_sink.hpp"
#include "mapping/facts/map_facts.hpp"
#include "mapping/ways/ways.hpp"
#include "perception/segments/scene.hpp"

namespace cluxel::mapping {

/// The facts about clouds and primitives. The arguments of the constructor must live as long.
class SceneFacts {
 public:
  SceneFacts(rdf::WriteTransaction& transaction, const MapInputs& inputs, const std::vector<Cloud>& clouds,
             const perception::Scene& scene);

  /// Collects them on a thread of its own when the ways are there, which may be made meanwhile. Nobody else may use the
  /// transaction until wait() or collect() has returned.
  void begin(std::shared_future<WayGraph> ways);
  /// Waits for the thread, if there is one.
  void wait();
  /// Collects them, unless a thread did.
  void collect();

  /// The sink of the observed graph; it has the facts when collect() has returned.
  FactSink& sink() { return *sink_; }

 private:
  void tell();

  rdf::WriteTransaction& transaction_;
  const MapInputs& inputs_;
  const std::vector<Cloud>& clouds_;
  const perception::Scene& scene_;
  std::optional<FactSink> sink_;
  std::future<void> telling_;  ///< its destructor waits
};

}  // namespace cluxel::mapping
