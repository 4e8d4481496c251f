// SPDX-License-Identifier: Apache-2.0
// A label map from its text.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "cluxel/scan/truth.hpp"

namespace cluxel {

/// Throws InputError with every fault, each with file:line:col.
std::map<std::uint32_t, LabelMeaning> parseLabelMap(std::string_view text, const std::string& file);

}  // namespace cluxel
