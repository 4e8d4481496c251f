// SPDX-License-Identifier: Apache-2.0
// Numbers out of little-endian bytes at any alignment.
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <type_traits>

namespace cluxel::scan {

static_assert(std::endian::native == std::endian::little, "binary scans are read in place as little-endian numbers");

/// The number at byte `offset`, which the caller has checked to lie inside `bytes`.
template <typename T>
requires std::is_arithmetic_v<T> T numberAt(std::string_view bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace cluxel::scan
