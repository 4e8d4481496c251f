// SPDX-License-Identifier: Apache-2.0
// The concurrent cache of decoded values.
#include "rdf/terms/value_cache.hpp"

#include <sys/mman.h>

#include <new>
#include <thread>

namespace cluxel::rdf {

ValueCache::~ValueCache() {
  for (auto& chunk : chunks_) {
    if (Slot* slots = chunk.load()) ::munmap(slots, kChunkSize * sizeof(Slot));
  }
}

ValueCache::Slot* ValueCache::makeChunk(std::size_t number) {
  // Zero-initialised and page-aligned, so that no slot crosses a cache line.
  void* const memory =
      ::mmap(nullptr, kChunkSize * sizeof(Slot), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  auto* made = static_cast<Slot*>(memory);
  Slot* present = nullptr;
  if (chunks_[number].compare_exchange_strong(present, made, std::memory_order_acq_rel)) return made;
  ::munmap(memory, kChunkSize * sizeof(Slot));
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

}  // namespace cluxel::rdf
