// SPDX-License-Identifier: Apache-2.0
// Stage outputs as bytes: kind, version, tile, then arrays in little space. Reading checks every length.
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

#include "base/packing/zstd_packing.hpp"
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
    head_.append(kind.substr(0, 4));
    for (const std::uint32_t number : {version, static_cast<std::uint32_t>(key.x), static_cast<std::uint32_t>(key.y)})
      head_.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  template <typename T>
  void put(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <typename T>
  void put(const std::vector<T>& values) {
    static_assert(kFlat<T>);
    appendArray(bytes_, values);
  }
  /// For numbers that are near the one before.
  void putSteps(const std::vector<std::uint32_t>& values) { put(differencesOf(values)); }
  /// What is computed again when it is needed is not stored. Its digest is, so that a change of it changes the bytes.
  template <typename T>
  void leaveOut(const std::vector<T>& values) {
    static_assert(kFlat<T>);
    const std::uint64_t count = values.size();
    left_out_.add(&count, sizeof count);
    left_out_.add(values.data(), values.size() * sizeof(T));
  }
  std::string take() { return head_ + left_out_.finish() + packedBytes(bytes_); }

 private:
  std::string head_, bytes_;
  FastDigest left_out_;
};

/// More than any tile of 16 m holds after thinning: 2^25 points at 32 bytes.
inline constexpr std::uint64_t kMaxTileBytes = std::uint64_t{1} << 30U;

class TileReader {
 public:
  TileReader(std::string_view bytes, std::string_view kind, std::uint32_t version) : rest_(bytes), kind_(kind) {
    if (bytes.substr(0, 4) != kind) fail("is of another kind");
    rest_.remove_prefix(4);
    if (get<std::uint32_t>() != version) failOther();
    key_.x = get<std::int32_t>();
    key_.y = get<std::int32_t>();
    if (rest_.size() < kDigestBytes) fail("is cut short");
    auto unpacked = unpackedBytes(rest_.substr(kDigestBytes), kMaxTileBytes);
    if (!unpacked) fail("cannot be unpacked");
    unpacked_ = *std::move(unpacked);
    rest_ = unpacked_.view();
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
    auto values = takeArray<T>(rest_);
    if (!values) fail("is cut short");
    return *std::move(values);
  }
  /// What putSteps() wrote.
  std::vector<std::uint32_t> getSteps() {
    auto values = getMany<std::uint32_t>();
    sumUp(values);
    return values;
  }
  std::vector<std::uint32_t> getSteps(std::size_t count) {
    auto values = getSteps();
    if (values.size() != count) fail("has arrays of different lengths");
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

  static constexpr std::size_t kDigestBytes = 16;
  UnpackedBytes unpacked_;
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
