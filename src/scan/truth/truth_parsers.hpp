// SPDX-License-Identifier: Apache-2.0
// Parsers of truth files and label maps, on text in memory.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scan/truth/truth.hpp"

namespace cluxel::scan {

/// Throws InputError with every fault, each with file:line:col.
LabelMapContent parseLabelMap(std::string_view text, const std::string& file);

/// Lines `primitive object instance`, plain or gzip. Throws InputError naming file and line.
PointTruth parseTruth(std::string_view bytes, const std::string& file, std::size_t point_count);

/// The `id` of rows whose column `ambiguous` is 1, sorted. Throws InputError naming file and line.
std::vector<std::int32_t> parseAmbiguousInstances(std::string_view text, const std::string& file);

}  // namespace cluxel::scan
