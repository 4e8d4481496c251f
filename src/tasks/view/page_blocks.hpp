// SPDX-License-Identifier: Apache-2.0
// Blocks of data in an HTML page: gzip, then base64, in script elements that no browser runs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tasks/export/map_export.hpp"

namespace cluxel::tasks {

std::string base64(std::string_view bytes);

/// Writes one data element with the id `name`, which the program chooses. The content is base64, so that nothing in a
/// map can end the element or begin another one. Returns the number of bytes written.
std::uint64_t writeBlock(const std::string& name, std::string_view bytes, const ByteSink& out);

}  // namespace cluxel::tasks
