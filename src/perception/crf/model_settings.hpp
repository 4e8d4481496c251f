// SPDX-License-Identifier: Apache-2.0
// Settings of the perception stages as a JSON object, keyed by their described names.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "perception/features/feature_tile.hpp"

namespace cluxel::perception {

nlohmann::ordered_json perceptionSettings(PerceptionParams params);

/// Throws std::invalid_argument when a setting is missing, unknown, of the wrong type or out of range.
PerceptionParams perceptionSettingsFrom(const nlohmann::ordered_json& json);

}  // namespace cluxel::perception
