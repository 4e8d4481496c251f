// SPDX-License-Identifier: Apache-2.0
// What a map object keeps between its calls, and the locks of its threads.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>

#include "mapping/newest_map.hpp"
#include "mapping/regions/answered_clouds.hpp"
#include "rdf/file/forks.hpp"

namespace cluxel {

struct KeptMap {
  explicit KeptMap(const std::filesystem::path& file) : map(file) {}

  const std::uint64_t forks = rdf::forkCount();  ///< of the process that made it
  std::mutex writing_mutex;                      ///< taken before the other; held while callbacks run
  std::mutex reading_mutex;                      ///< guards `map`; not held while callbacks run
  mapping::NewestMap map;
  std::mutex points_mutex;  ///< guards `answers`; not held while callbacks run, nor together with reading_mutex
  std::optional<mapping::KeptAnswers> answers;
};

/// The KeptMap of the process that asks. A forked child process gets another one: a thread that held a lock, or was
/// changing something, at that moment does not exist in the child. There the parent's one is never used or destroyed.
class KeptMapOfProcess {
 public:
  explicit KeptMapOfProcess(const std::filesystem::path& file) : file_(file), kept_(new KeptMap(file)) {}
  KeptMapOfProcess(const KeptMapOfProcess&) = delete;
  KeptMapOfProcess& operator=(const KeptMapOfProcess&) = delete;
  ~KeptMapOfProcess() {
    if (const KeptMap* kept = kept_; kept->forks == rdf::forkCount()) delete kept;
  }

  /// Thread-safe.
  KeptMap& get() const {
    KeptMap* kept = kept_;
    if (kept->forks == rdf::forkCount()) return *kept;
    auto own = std::make_unique<KeptMap>(file_);
    return kept_.compare_exchange_strong(kept, own.get()) ? *own.release() : *kept;
  }

 private:
  const std::filesystem::path& file_;
  mutable std::atomic<KeptMap*> kept_;
};

}  // namespace cluxel
