// SPDX-License-Identifier: Apache-2.0
// Fuzz input as edits of a valid text, so that a fuzzer gets past hashes, counts and versions.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace cluxel::fuzz {

/// Each edit: three bytes of place, one of length, and what is written over; the size stays.
inline std::string overwritten(std::string text, std::string_view edits) {
  const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<std::uint8_t>(edits[i])); };
  while (edits.size() >= 5) {
    const std::size_t place = (byte(0) | byte(1) << 8U | byte(2) << 16U) % text.size();
    const std::size_t count = std::min({byte(3) % 16 + 1, edits.size() - 4, text.size() - place});
    text.replace(place, count, edits.substr(4, count));
    edits.remove_prefix(4 + count);
  }
  return text;
}

/// Each edit: three bytes of place, one of how much goes, one of how much comes, and what comes.
inline std::string edited(std::string text, std::string_view edits) {
  const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<std::uint8_t>(edits[i])); };
  while (edits.size() >= 5) {
    const std::size_t place = (byte(0) | byte(1) << 8U | byte(2) << 16U) % (text.size() + 1);
    const std::size_t gone = byte(3), come = std::min(byte(4), edits.size() - 5);
    text.replace(place, gone, edits.substr(5, come));
    edits.remove_prefix(5 + come);
  }
  return text;
}

}  // namespace cluxel::fuzz
