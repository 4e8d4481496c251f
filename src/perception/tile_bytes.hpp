// SPDX-License-Identifier: Apache-2.0
// Stage outputs as bytes: kind, version, then flat little-endian arrays. Reading checks every length.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "cluxel/error.hpp"
#include "perception/tile.hpp"

namespace cluxel::perception {

static_assert(std::endian::native == std::endian::little, "stored tiles are little-endian");

/// Types that may be copied as bytes: numbers, plain structs without padding, and fixed-size Eigen vectors.
template <typename T>
inline constexpr bool kFlat = std::is_trivially_copyable_v<T> || std::is_same_v<T, Eigen::Vector3f>;

class TileWriter {
 public:
  /// `kind` is four letters; `version` changes with the layout.
  TileWriter(std::string_view kind, std::uint32_t version, const TileKey& key) {
    bytes_.append(kind.substr(0, 4));
    put(version);
    put(key.x);
    put(key.y);
  }
  template <typename T>
  void put(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <typename T>
  void put(const std::vector<T>& values) {
    static_assert(kFlat<T>);
    put(static_cast<std::uint64_t>(values.size()));
    if (!values.empty()) bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class TileReader {
 public:
  TileReader(std::string_view bytes, std::string_view kind, std::uint32_t version) : rest_(bytes), kind_(kind) {
    if (bytes.substr(0, 4) != kind) fail("is of another kind");
    rest_.remove_prefix(4);
    if (get<std::uint32_t>() != version) failOther();
    key_.x = get<std::int32_t>();
    key_.y = get<std::int32_t>();
  }
  const TileKey& key() const { return key_; }

  template <typename T>
  T get() {
    static_assert(std::is_arithmetic_v<T>);
    if (rest_.size() < sizeof(T)) fail("is cut short");
    T value;
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
    return value;
  }
  template <typename T>
  std::vector<T> getMany() {
    static_assert(kFlat<T>);
    const auto count = get<std::uint64_t>();
    if (count > rest_.size() / sizeof(T)) fail("is cut short");
    std::vector<T> values(count);
    if (count > 0) std::memcpy(static_cast<void*>(values.data()), rest_.data(), count * sizeof(T));
    rest_.remove_prefix(count * sizeof(T));
    return values;
  }
  /// An array that must have a certain length, or may be absent when `optional`.
  template <typename T>
  std::vector<T> getMany(std::size_t count, bool optional = false) {
    auto values = getMany<T>();
    if (values.size() != count && !(optional && values.empty())) fail("has arrays of different lengths");
    return values;
  }
  void require(bool holds, const char* what) const {
    if (!holds) fail(what);
  }
  void finish() const { require(rest_.empty(), "has bytes left over"); }

 private:
  [[noreturn]] void fail(const char* what) const {
    throw Error(ErrorKind::StoreUnavailable,
                "stored block " + std::string(kind_) + " " + what + "; the map is damaged, build it anew");
  }

  [[noreturn]] void failOther() const {
    throw Error(ErrorKind::StoreUnavailable,
                "stored block " + std::string(kind_) +
                    " is of another version of cluxel, which writes it in another form; build the map anew");
  }

  std::string_view rest_, kind_;
  TileKey key_;
};

/// Whether all values are finite and at most `limit` in magnitude.
inline bool allWithin(std::span<const float> values, double limit) {
  for (const float value : values)
    if (!(std::abs(value) <= limit)) return false;
  return true;
}

inline bool allWithin(std::span<const Eigen::Vector3f> values, double limit) {
  for (const auto& value : values)
    if (!(value.cwiseAbs().maxCoeff() <= limit) || !value.allFinite()) return false;
  return true;
}

inline bool allBelow(std::span<const std::uint32_t> values, std::size_t bound) {
  for (const auto value : values)
    if (value >= bound) return false;
  return true;
}

/// Whether `offset` is a CSR offset array over `items` items.
inline bool isOffsets(std::span<const std::uint32_t> offset, std::size_t items) {
  if (offset.empty() || offset.front() != 0 || offset.back() != items) return false;
  for (std::size_t i = 1; i < offset.size(); ++i)
    if (offset[i] < offset[i - 1]) return false;
  return true;
}

}  // namespace cluxel::perception
