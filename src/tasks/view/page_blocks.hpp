// SPDX-License-Identifier: Apache-2.0
// Blocks of data in an HTML page: gzip, then base64, in script elements that no browser runs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tasks/export/map_export.hpp"

namespace cluxel::tasks {

/// The bytes as gzip (RFC 1952) without time and name, so that equal bytes give equal blocks.
std::string gzipped(std::string_view bytes);
std::string base64(std::string_view bytes);

/// Writes one data element with the id `name`, which the program chooses. The content is base64, so that nothing in a
/// map can end the element or begin another one. Returns the number of bytes written.
std::uint64_t writeBlock(const std::string& name, std::string_view bytes, const ByteSink& out);

/// The values as planes: the lowest bytes of all values, then the next higher ones. gzip finds more in planes.
template <typename T>
void appendPlanes(const std::vector<T>& values, std::size_t bytes_per_value, std::string& bytes) {
  for (std::size_t plane = 0; plane < bytes_per_value; ++plane)
    for (const T value : values) bytes.push_back(static_cast<char>((value >> (8 * plane)) & 0xff));
}

}  // namespace cluxel::tasks
