// SPDX-License-Identifier: Apache-2.0
// The file that a build works in: the map itself, or one beside it that takes its place when it is finished.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "cluxel/base/progress.hpp"
#include "cluxel/knowledge/environment.hpp"
#include "cluxel/mapping/build_lock.hpp"
#include "mapping/map_state.hpp"

namespace cluxel {

class WorkFile {
 public:
  /// Looks at what lies at `map` and at MAP.building, under the lock that is held as long as this lives, and opens the
  /// one to work in. A finished map, or a store that no build has made, is an Error (Usage) unless `force`; what
  /// another build left unfinished always is.
  WorkFile(const std::filesystem::path& map, const std::string& inputs_hash, bool force);
  WorkFile(const WorkFile&) = delete;
  WorkFile& operator=(const WorkFile&) = delete;
  /// Removes a file that was made here and holds no commit of the build.
  ~WorkFile();

  Environment& environment() { return *environment_; }
  const std::filesystem::path& path() const { return path_; }
  /// What the file said when it was opened; absent: nothing is in it.
  const std::optional<MapState>& found() const { return found_; }

  /// For the last transaction of the build: the operator's statements of the map that is replaced, as they are now.
  /// That map can be written by nobody else from here on until this file has taken its place.
  void takeOverStatements(WriteTransaction& into, bool drop, ProgressSink& sink);
  /// Makes the finished file the map.
  void finish();

 private:
  void chooseBetween(const std::string& inputs_hash, bool force);

  std::filesystem::path target_, path_;
  BuildLock lock_;
  std::shared_ptr<Environment> environment_;
  std::optional<MapState> found_;
  std::optional<WriteTransaction> replaced_;  ///< nobody else writes to the old map
  bool replaces_ = false;
};

}  // namespace cluxel
