// SPDX-License-Identifier: Apache-2.0
// Hashes of content: they name scans, primitives and objects, and tell whether a stage's input has changed.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace cluxel {

/// The first 128 bits of a SHA-256. Ordered by bytes, so that an order by hash is the same on every machine.
struct ContentHash {
  std::array<std::uint8_t, 16> bytes{};

  auto operator<=>(const ContentHash&) const = default;
  bool isZero() const { return *this == ContentHash{}; }
  std::string hex() const;  ///< 32 lower-case hexadecimal digits
  /// Reads what hex() wrote; throws std::invalid_argument on anything else.
  static ContentHash fromHex(std::string_view digits);
};

/// Collects content and hashes it. Numbers are hashed as their little-endian bytes.
class ContentHasher {
 public:
  ContentHasher();
  ~ContentHasher();
  ContentHasher(ContentHasher&&) noexcept;
  ContentHasher& operator=(ContentHasher&&) noexcept;

  ContentHasher& addBytes(const void* data, std::size_t size);
  /// The length goes in first, so that "ab","c" and "a","bc" differ.
  ContentHasher& addText(std::string_view text);
  ContentHasher& add(const ContentHash& hash) { return addBytes(hash.bytes.data(), hash.bytes.size()); }

  template <typename T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) ContentHasher& add(T value) {
    return addBytes(&value, sizeof value);
  }

  /// The number of elements goes in first.
  template <typename T>
  requires std::has_unique_object_representations_v<T> || std::is_floating_point_v<T> ContentHasher& addSpan(
      std::span<const T> values) {
    return add(static_cast<std::uint64_t>(values.size())).addBytes(values.data(), values.size_bytes());
  }

  /// The hash of all that was added; the hasher is spent afterwards.
  ContentHash finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The whole SHA-256 of a text: 64 lower-case hexadecimal digits.
std::string sha256Of(std::string_view text);

}  // namespace cluxel

template <>
struct std::hash<cluxel::ContentHash> {
  std::size_t operator()(const cluxel::ContentHash& hash) const noexcept {
    std::size_t value = 0;
    std::memcpy(&value, hash.bytes.data(), sizeof value);
    return value;
  }
};
