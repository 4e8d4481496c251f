// SPDX-License-Identifier: Apache-2.0
// A set of numbers without a lock: a thread that held one does not exist in the child.
#include "rdf/file/forks.hpp"

#include <pthread.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstddef>

namespace cluxel::rdf {

namespace {

constexpr std::size_t kBitsOfWord = 64, kNumbers = 65536;

std::atomic<std::uint64_t> forks{0};
std::array<std::atomic<std::uint64_t>, kNumbers / kBitsOfWord> closed_in_children{};

void beginChild() {
  forks.fetch_add(1, std::memory_order_relaxed);
  for (std::size_t word = 0; word < closed_in_children.size(); ++word) {
    const std::uint64_t bits = closed_in_children[word].exchange(0);
    for (std::size_t bit = 0; bit < kBitsOfWord; ++bit)
      if ((bits >> bit & 1U) != 0) ::close(static_cast<int>(word * kBitsOfWord + bit));
  }
}

void watchForks() {
  static const int registered = ::pthread_atfork(nullptr, nullptr, &beginChild);
  static_cast<void>(registered);
}

bool hasPlace(int descriptor) {
  return descriptor >= 0 && static_cast<std::size_t>(descriptor) < kNumbers;
}

std::uint64_t bitOf(int descriptor) {
  return std::uint64_t{1} << (static_cast<std::size_t>(descriptor) % kBitsOfWord);
}

std::atomic<std::uint64_t>& wordOf(int descriptor) {
  return closed_in_children[static_cast<std::size_t>(descriptor) / kBitsOfWord];
}

}  // namespace

std::uint64_t forkCount() {
  watchForks();
  return forks.load(std::memory_order_relaxed);
}

void closeInChildren(int descriptor) {
  watchForks();
  if (hasPlace(descriptor)) wordOf(descriptor).fetch_or(bitOf(descriptor));
}

void keepInChildren(int descriptor) {
  if (hasPlace(descriptor)) wordOf(descriptor).fetch_and(~bitOf(descriptor));
}

}  // namespace cluxel::rdf
