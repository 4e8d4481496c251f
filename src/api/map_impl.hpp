// SPDX-License-Identifier: Apache-2.0
// What is behind a Map: the file, what is kept of it between calls, and how calls read and write it.
#pragma once

#include <mutex>

#include "api/guarded_call.hpp"
#include "api/kept_map.hpp"
#include "cluxel/map.hpp"

namespace cluxel {

struct Map::Impl {
  explicit Impl(const std::filesystem::path& map_file) : file(map_file), kept(file) {}

  /// What `read` gives for the newest state. Other readers wait, writers do not.
  template <typename Read>
  auto reading(const Read& read) {
    return guarded([&] {
      KeptMap& mine = kept.get();
      const std::lock_guard lock(mine.reading_mutex);
      return read(mine.map.reader());
    });
  }
  /// The same with a reader of its own, for what takes long. Readers do not wait for each other, but for layers of the
  /// commit that another one is reading: each layer is read once.
  template <typename Read>
  auto readingAlone(const Read& read) const {
    return guarded([&] {
      const mapping::MapReader reader(file);
      return read(reader);
    });
  }
  /// What `read` gives for the newest state with what is kept of its points. Readers of points wait for each other.
  template <typename Read>
  auto readingPoints(const Read& read) {
    return guarded([&] {
      KeptMap& mine = kept.get();
      const std::lock_guard lock(mine.points_mutex);
      const mapping::MapReader reader(file);
      if (!mine.answers || !mine.answers->isOf(reader)) mine.answers.emplace(reader);
      return read(reader, *mine.answers);
    });
  }
  rdf::QuadReader newestQuads() const {
    return guarded([&] { return kept.get().map.quads(); });
  }
  /// Runs `write` when no other thread writes through this object; `write` takes the sink of its callbacks.
  template <typename Write>
  auto writing(ProgressSink& caller, const Write& write) {
    WritingCall call(file, caller);
    return guarded(
        [&] {
          std::unique_lock lock(kept.get().writing_mutex, std::defer_lock);
          // Two calls whose callbacks write each other's map would wait for each other.
          if (!call.isInCallback())
            lock.lock();
          else if (!lock.try_lock())
            throw Error(ErrorKind::StoreUnavailable,
                        file.string() + ": another thread is writing this map; callbacks do not wait for it");
          forget();  // the pages that it keeps can be used again once there is a newer commit
          return write(call);
        },
        &call);
  }
  void forget() {
    KeptMap& mine = kept.get();
    {
      const std::lock_guard lock(mine.reading_mutex);
      mine.map.release();
    }
    const std::lock_guard lock(mine.points_mutex);
    mine.answers.reset();
  }

  const std::filesystem::path file;
  const KeptMapOfProcess kept;
};

}  // namespace cluxel
