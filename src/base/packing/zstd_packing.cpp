// SPDX-License-Identifier: Apache-2.0
// The loops over planes and differences, and the calls of zstd and xxHash.
#include "base/packing/zstd_packing.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>
#include <zstd.h>

#include <bit>
#include <new>

#include "cluxel/error.hpp"

namespace cluxel {

namespace {

constexpr int kLevel = 1;
/// A frame cannot hold more: the shortest block is 4 bytes for 128 KiB.
constexpr std::uint64_t kMaxRatio = std::uint64_t{1} << 15U;

/// A number that ascends with the float; a bijection of the bits.
std::uint32_t orderOf(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return bits ^ ((0U - (bits >> 31U)) | 0x80000000U);
}

float floatOf(std::uint32_t order) {
  return std::bit_cast<float>(order ^ ((0U - (~order >> 31U)) | 0x80000000U));
}

/// Words are split and joined whole: the compiler makes vector instructions of it.
void splitWords(const char* items, std::size_t count, char* planes) {
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t item = 0;
    std::memcpy(&item, items + 4 * i, sizeof item);
    planes[i] = static_cast<char>(item);
    planes[count + i] = static_cast<char>(item >> 8U);
    planes[2 * count + i] = static_cast<char>(item >> 16U);
    planes[3 * count + i] = static_cast<char>(item >> 24U);
  }
}

void joinWords(const char* planes, std::size_t count, char* items) {
  const auto byteAt = [planes](std::size_t i) { return std::uint32_t{static_cast<unsigned char>(planes[i])}; };
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t item =
        byteAt(i) | byteAt(count + i) << 8U | byteAt(2 * count + i) << 16U | byteAt(3 * count + i) << 24U;
    std::memcpy(items + 4 * i, &item, sizeof item);
  }
}

/// One context a thread, because making one costs as much as unpacking a small block.
ZSTD_DCtx* unpacking() {
  struct Free {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
  };
  thread_local const std::unique_ptr<ZSTD_DCtx, Free> context(ZSTD_createDCtx());
  if (!context) throw std::bad_alloc();
  return context.get();
}

}  // namespace

std::string packedBytes(std::string_view bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kLevel);
  if (ZSTD_isError(size) != 0)
    throw Error(ErrorKind::StoreUnavailable, std::string("zstd: ") + ZSTD_getErrorName(size));
  packed.resize(size);
  return packed;
}

std::optional<std::uint64_t> statedBytes(std::string_view packed) {
  const unsigned long long stated = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (stated == ZSTD_CONTENTSIZE_UNKNOWN || stated == ZSTD_CONTENTSIZE_ERROR) return std::nullopt;
  return stated;
}

std::optional<UnpackedBytes> unpackedBytes(std::string_view packed, std::uint64_t max_bytes) {
  const auto stated = statedBytes(packed);
  if (!stated || *stated > max_bytes || *stated / kMaxRatio > packed.size()) return std::nullopt;
  if (ZSTD_findFrameCompressedSize(packed.data(), packed.size()) != packed.size()) return std::nullopt;
  UnpackedBytes bytes{std::make_unique_for_overwrite<char[]>(*stated), *stated};
  const std::size_t size = ZSTD_decompressDCtx(unpacking(), bytes.data.get(), *stated, packed.data(), packed.size());
  if (ZSTD_isError(size) != 0 || size != *stated) return std::nullopt;
  return bytes;
}

void appendPlanes(std::string& bytes, const void* items, std::size_t count, std::size_t item_bytes) {
  const std::size_t first = bytes.size();
  bytes.resize(first + count * item_bytes);
  char* planes = bytes.data() + first;
  const char* from = static_cast<const char*>(items);
  if (item_bytes == 4) return splitWords(from, count, planes);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t plane = 0; plane < item_bytes; ++plane) planes[plane * count + i] = from[i * item_bytes + plane];
}

void readPlanes(const char* planes, void* items, std::size_t count, std::size_t item_bytes) {
  char* to = static_cast<char*>(items);
  if (item_bytes == 4) return joinWords(planes, count, to);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t plane = 0; plane < item_bytes; ++plane) to[i * item_bytes + plane] = planes[plane * count + i];
}

std::vector<std::uint32_t> differencesOf(const std::vector<std::uint32_t>& values) {
  std::vector<std::uint32_t> differences(values.size());
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < values.size(); last = values[i++]) differences[i] = zigzag(values[i] - last);
  return differences;
}

std::vector<std::uint32_t> differencesOf(const std::vector<float>& values) {
  std::vector<std::uint32_t> differences(values.size());
  std::uint32_t last = orderOf(0.0F);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint32_t order = orderOf(values[i]);
    differences[i] = zigzag(order - last);
    last = order;
  }
  return differences;
}

void sumUp(std::vector<std::uint32_t>& values) {
  std::uint32_t last = 0;
  for (std::uint32_t& value : values) value = last += unzigzag(value);
}

void sumUp(const std::vector<std::uint32_t>& differences, std::vector<float>& values) {
  values.resize(differences.size());
  std::uint32_t last = orderOf(0.0F);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = floatOf(last += unzigzag(differences[i]));
}

struct FastDigest::State {
  XXH3_state_t state;
};

FastDigest::FastDigest() : state_(std::make_unique<State>()) {
  XXH3_128bits_reset(&state_->state);
}
FastDigest::~FastDigest() = default;
FastDigest::FastDigest(FastDigest&&) noexcept = default;
FastDigest& FastDigest::operator=(FastDigest&&) noexcept = default;

void FastDigest::add(const void* bytes, std::size_t size) {
  if (size > 0) XXH3_128bits_update(&state_->state, bytes, size);
}

std::string FastDigest::finish() const {
  XXH128_canonical_t bytes;
  XXH128_canonicalFromHash(&bytes, XXH3_128bits_digest(&state_->state));
  return {reinterpret_cast<const char*>(bytes.digest), sizeof bytes.digest};
}

}  // namespace cluxel
