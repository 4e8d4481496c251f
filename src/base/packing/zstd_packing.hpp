// SPDX-License-Identifier: Apache-2.0
// Arrays in little space: differences of neighbours, the bytes of equal weight side by side, then zstd. What is read
// back has the same bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace cluxel {

/// The bytes as a zstd frame that states their number.
std::string packedBytes(std::string_view bytes);

/// Bytes on the heap that nothing has filled with zeros.
struct UnpackedBytes {
  std::unique_ptr<char[]> data;
  std::size_t size = 0;
  std::string_view view() const { return {data.get(), size}; }
};
/// What packedBytes() made `packed` from; none when it is damaged. A frame that states more bytes than its length can
/// hold, or more than `max_bytes`, is refused before memory is asked for.
std::optional<UnpackedBytes> unpackedBytes(std::string_view packed, std::uint64_t max_bytes);
/// How many bytes `packed` states to hold, without unpacking them; none when it is damaged.
std::optional<std::uint64_t> statedBytes(std::string_view packed);

/// Appends the first byte of each item, then the second of each, and so on.
void appendPlanes(std::string& bytes, const void* items, std::size_t count, std::size_t item_bytes);
/// Reads what appendPlanes() appended: count * item_bytes bytes.
void readPlanes(const char* planes, void* items, std::size_t count, std::size_t item_bytes);

/// Appends the number of values, then their planes. `T` may be copied as bytes.
template <typename T>
void appendArray(std::string& bytes, const std::vector<T>& values) {
  const std::uint64_t count = values.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  appendPlanes(bytes, values.data(), values.size(), sizeof(T));
}
/// Removes from the front of `bytes` what appendArray() appended; none when they are cut short.
template <typename T>
std::optional<std::vector<T>> takeArray(std::string_view& bytes) {
  std::uint64_t count = 0;
  if (bytes.size() < sizeof count) return std::nullopt;
  std::memcpy(&count, bytes.data(), sizeof count);
  if (count > (bytes.size() - sizeof count) / sizeof(T)) return std::nullopt;
  std::vector<T> values(count);
  readPlanes(bytes.data() + sizeof count, values.data(), count, sizeof(T));
  bytes.remove_prefix(sizeof count + count * sizeof(T));
  return values;
}

/// Small numbers for small differences of either sign.
constexpr std::uint32_t zigzag(std::uint32_t difference) {
  return (difference << 1U) ^ (0U - (difference >> 31U));
}
constexpr std::uint32_t unzigzag(std::uint32_t value) {
  return (value >> 1U) ^ (0U - (value & 1U));
}

/// The zigzag of the difference of each number to the one before. Floats count by their order, so that near values have
/// near numbers.
std::vector<std::uint32_t> differencesOf(const std::vector<std::uint32_t>& values);
std::vector<std::uint32_t> differencesOf(const std::vector<float>& values);
/// Turns differences into the values, in place.
void sumUp(std::vector<std::uint32_t>& values);
void sumUp(const std::vector<std::uint32_t>& differences, std::vector<float>& values);

/// 128 bits that tell two contents apart, much faster than a ContentHash. Not for names: it resists no attack.
class FastDigest {
 public:
  FastDigest();
  ~FastDigest();
  FastDigest(FastDigest&&) noexcept;
  FastDigest& operator=(FastDigest&&) noexcept;
  void add(const void* bytes, std::size_t size);
  std::string finish() const;  ///< 16 bytes

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cluxel
