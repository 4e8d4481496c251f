// SPDX-License-Identifier: Apache-2.0
// The rolling hashes of a run.
#include "rules/decide/trace_recorder.hpp"

namespace cluxel::rules {

std::uint64_t hashOf(std::string_view text) {
  std::uint64_t hash = 0xCBF29CE484222325U;  // FNV-1a
  for (const char byte : text) hash = (hash ^ static_cast<std::uint8_t>(byte)) * 0x100000001B3U;
  return hash;
}

void TraceRecorder::enter(std::uint64_t part) {
  part_ = part;
  round_ = mixed(part_, std::uint64_t{0});
  known_.clear();
}

bool TraceRecorder::isNews(std::uint64_t thing, std::uint64_t what) {
  const auto [entry, fresh] = known_.try_emplace(thing, what);
  if (!fresh && entry->second == what) return false;
  entry->second = what;
  return true;
}

}  // namespace cluxel::rules
