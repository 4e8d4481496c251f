// SPDX-License-Identifier: Apache-2.0
// A lazily filled cache of the decoded values of committed terms, shared by all readers: terms are immutable.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>

#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

class ValueCache {
 public:
  ValueCache() = default;
  ValueCache(const ValueCache&) = delete;
  ValueCache& operator=(const ValueCache&) = delete;
  ~ValueCache();

  /// The value of `id`; calls `decode(id)` on a miss. Thread-safe.
  template <typename Decode>
  const DecodedValue& get(TermId id, const Decode& decode) {
    Slot* chunk = chunks_[id >> kChunkBits].load(std::memory_order_acquire);
    if (chunk == nullptr) chunk = makeChunk(id >> kChunkBits);
    Slot& slot = chunk[id & (kChunkSize - 1)];
    std::atomic_ref<std::uint8_t> state(slot.state);
    if (state.load(std::memory_order_acquire) != kReady) fill(slot, [&] { return decode(id); });
    return slot.value;
  }
  /// Prefetches the slot of `id`.
  void expect(TermId id) const {
    const Slot* chunk = chunks_[id >> kChunkBits].load(std::memory_order_acquire);
    if (chunk != nullptr) __builtin_prefetch(&chunk[id & (kChunkSize - 1)]);
  }

 private:
  static constexpr unsigned kChunkBits = 16;
  static constexpr std::size_t kChunkSize = std::size_t{1} << kChunkBits;
  static constexpr std::uint8_t kEmpty = 0, kFilling = 1, kReady = 2;

  /// An empty slot is all zero, so that fresh memory needs no initialisation. Two slots fill a cache line.
  struct alignas(32) Slot {
    DecodedValue value;
    std::uint8_t state;
  };

  Slot* makeChunk(std::size_t number);
  static void fill(Slot& slot, const std::function<DecodedValue()>& decode);

  std::array<std::atomic<Slot*>, (std::uint64_t{1} << 32U) / kChunkSize> chunks_{};
};

}  // namespace cluxel::rdf
