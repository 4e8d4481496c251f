// SPDX-License-Identifier: Apache-2.0
// Settings of the perception stages as a JSON object, by the names their descriptions give.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "cluxel/perception/tile_pipeline.hpp"

namespace cluxel {

nlohmann::ordered_json perceptionSettings(PerceptionParams params);

/// Throws std::invalid_argument when a setting is missing, unknown, of another kind or out of range.
PerceptionParams perceptionSettingsFrom(const nlohmann::ordered_json& json);

}  // namespace cluxel
