// SPDX-License-Identifier: Apache-2.0
// Filling of the value cache by several threads at once.
#include "knowledge/value_cache.hpp"

#include <cstdlib>
#include <new>
#include <thread>

namespace cluxel {

ValueCache::~ValueCache() {
  for (auto& chunk : chunks_) std::free(chunk.load());
}

ValueCache::Slot* ValueCache::makeChunk(std::size_t number) {
  auto* made = static_cast<Slot*>(std::calloc(kChunkSize, sizeof(Slot)));
  if (made == nullptr) throw std::bad_alloc();
  Slot* present = nullptr;
  if (chunks_[number].compare_exchange_strong(present, made, std::memory_order_acq_rel)) return made;
  std::free(made);
  return present;
}

void ValueCache::fill(Slot& slot, const std::function<DecodedValue()>& decode) {
  const DecodedValue value = decode();
  std::atomic_ref<std::uint8_t> state(slot.state);
  std::uint8_t expected = kEmpty;
  if (state.compare_exchange_strong(expected, kFilling, std::memory_order_acquire)) {
    slot.value = value;
    state.store(kReady, std::memory_order_release);
    return;
  }
  while (state.load(std::memory_order_acquire) != kReady) std::this_thread::yield();
}

}  // namespace cluxel
