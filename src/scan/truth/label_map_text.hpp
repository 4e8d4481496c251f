// SPDX-License-Identifier: Apache-2.0
// A label map from its text.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "scan/truth/truth.hpp"

namespace cluxel::scan {

/// Throws InputError with every fault, each with file:line:col.
std::map<std::uint32_t, LabelMeaning> parseLabelMap(std::string_view text, const std::string& file);

}  // namespace cluxel::scan
