// SPDX-License-Identifier: Apache-2.0
// The decoded values of committed terms, filled as they are asked for and shared by all readers: a term never
// changes.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>

#include "cluxel/knowledge/quad_store.hpp"

namespace cluxel {

class ValueCache {
 public:
  ValueCache() = default;
  ValueCache(const ValueCache&) = delete;
  ValueCache& operator=(const ValueCache&) = delete;
  ~ValueCache();

  /// The value of `id`, from `decode(id)` when it is asked for first. Thread-safe.
  template <typename Decode>
  const DecodedValue& get(TermId id, const Decode& decode) {
    Slot* chunk = chunks_[id >> kChunkBits].load(std::memory_order_acquire);
    if (chunk == nullptr) chunk = makeChunk(id >> kChunkBits);
    Slot& slot = chunk[id & (kChunkSize - 1)];
    std::atomic_ref<std::uint8_t> state(slot.state);
    if (state.load(std::memory_order_acquire) != kReady) fill(slot, [&] { return decode(id); });
    return slot.value;
  }
  /// Asks the memory for the slot of `id`.
  void expect(TermId id) const {
    const Slot* chunk = chunks_[id >> kChunkBits].load(std::memory_order_acquire);
    if (chunk != nullptr) __builtin_prefetch(&chunk[id & (kChunkSize - 1)]);
  }
  /// True when get() need not decode.
  bool has(TermId id) const {
    Slot* chunk = chunks_[id >> kChunkBits].load(std::memory_order_acquire);
    if (chunk == nullptr) return false;
    return std::atomic_ref<std::uint8_t>(chunk[id & (kChunkSize - 1)].state).load(std::memory_order_relaxed) == kReady;
  }

 private:
  static constexpr unsigned kChunkBits = 16;
  static constexpr std::size_t kChunkSize = std::size_t{1} << kChunkBits;
  static constexpr std::uint8_t kEmpty = 0, kFilling = 1, kReady = 2;

  /// All zero bytes are an empty slot, so that fresh memory needs no visit. Two slots fill a cache line.
  struct alignas(32) Slot {
    DecodedValue value;
    std::uint8_t state;
  };

  Slot* makeChunk(std::size_t number);
  static void fill(Slot& slot, const std::function<DecodedValue()>& decode);

  std::array<std::atomic<Slot*>, (std::uint64_t{1} << 32U) / kChunkSize> chunks_{};
};

}  // namespace cluxel
