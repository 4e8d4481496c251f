// SPDX-License-Identifier: Apache-2.0
// Sorts byte strings that need not fit into memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/sorting/temporary_bytes.hpp"

namespace cluxel {

/// Byte strings, given back in bytewise order, each once. What exceeds a limit of memory goes as sorted runs to a file
/// without a name in the folder for temporary files, and the runs are merged. Memory is at most some two and a half
/// times the limit, and 4 KiB a run.
class SortedRecords {
 public:
  static constexpr std::size_t kUsualBytes = std::size_t{64} << 20U;

  explicit SortedRecords(std::size_t bytes_in_memory = kUsualBytes) : limit_(bytes_in_memory) {}
  SortedRecords(const SortedRecords&) = delete;
  SortedRecords& operator=(const SortedRecords&) = delete;

  /// Throws Error (StoreUnavailable) when the folder for temporary files cannot be used or is full.
  void add(std::string_view record);
  /// Calls `take` for all records and forgets them. The view is valid during the call. Throws as add(), or what `take`
  /// throws.
  void drain(const std::function<void(std::string_view)>& take);

 private:
  struct Place {
    std::size_t begin = 0;
    std::uint32_t size = 0;
  };
  struct Run {
    std::uint64_t begin = 0, end = 0;  ///< in the file
  };
  class RunReader;

  std::string_view viewOf(const Place& place) const { return {bytes_.data() + place.begin, place.size}; }
  void sortMemory();
  void writeRun();
  void mergeRuns(const std::function<void(std::string_view)>& take);
  void forget();

  std::size_t limit_;
  std::string bytes_;
  std::vector<Place> places_;
  std::vector<Run> runs_;
  TemporaryBytes file_;
};

}  // namespace cluxel
