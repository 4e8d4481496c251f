// SPDX-License-Identifier: Apache-2.0
// A label map from its text.
#pragma once

#include <string>
#include <string_view>

#include "scan/truth/truth.hpp"

namespace cluxel::scan {

/// Throws InputError with every fault, each with file:line:col.
LabelMapContent parseLabelMap(std::string_view text, const std::string& file);

}  // namespace cluxel::scan
