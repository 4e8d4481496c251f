// SPDX-License-Identifier: Apache-2.0
// All stages from scans to the scene in memory: for rule tests on clouds, tests and benchmarks. Maps run them from
// storage.
#pragma once

#include <span>

#include "cluxel/perception/labelling.hpp"
#include "cluxel/perception/scene_assembly.hpp"
#include "cluxel/perception/tile_pipeline.hpp"

namespace cluxel {

/// Settings of the stages behind the features.
struct SceneParams {
  LabellingParams labelling;
  ComponentParams component;
  ContactParams contact;
  RelationParams relation;
};

/// The scene of some scans, which may come in any order; the outcome does not depend on `threads`.
Scene sceneOf(std::span<const Scan> scans, const LabelModel& model, const SceneParams& params, unsigned threads);

}  // namespace cluxel
