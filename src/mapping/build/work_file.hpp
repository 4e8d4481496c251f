// SPDX-License-Identifier: Apache-2.0
// The file that a build writes: the map itself, or a file beside it that replaces the map at the end.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "cluxel/progress.hpp"
#include "mapping/build/build_lock.hpp"
#include "mapping/map_state.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Whether there is no map of this name, or one whose build was interrupted. Throws Error (StoreUnavailable) for what
/// is no map.
bool hasBuildToDo(const std::filesystem::path& map);

/// Throws Error (StoreUnavailable) for a file of a first build without a commit. A store that was loaded from an empty
/// RDF file is accepted.
void refuseUncommittedBuild(const rdf::ReadTransaction& transaction, const std::filesystem::path& file);

class WorkFile {
 public:
  /// Takes the build lock, inspects `map` and MAP.building, and opens the file to build in. Throws Error
  /// (InvalidArgument) for a finished map, or a store that no build has made, unless `force`; always for an unfinished
  /// build of other inputs.
  WorkFile(const std::filesystem::path& map, const std::string& inputs_hash, bool force);
  WorkFile(const WorkFile&) = delete;
  WorkFile& operator=(const WorkFile&) = delete;
  /// Removes a file that was created here and has no commit.
  ~WorkFile();

  rdf::Environment& environment() { return *environment_; }
  /// Opens the file again: LMDB keeps the memory of as many pages as its largest transaction has written. No
  /// transaction may be open.
  void reopen();
  const std::filesystem::path& path() const { return path_; }
  /// The state of the file when it was opened; absent when it is empty.
  const std::optional<MapState>& found() const { return found_; }

  /// For the last transaction of the build: copies the current operator's statements of the map that will be replaced,
  /// and blocks other writers of that map until it is replaced.
  void takeOverStatements(rdf::WriteTransaction& into, bool drop, ProgressSink& sink);
  /// Replaces the map by the finished file.
  void finish();

 private:
  void chooseBetween(const std::string& inputs_hash, bool force);

  std::filesystem::path target_, path_;
  BuildLock lock_;
  std::shared_ptr<rdf::Environment> environment_;
  std::optional<MapState> found_;
  std::optional<rdf::WriteTransaction> replaced_;  ///< keeps other writers out of the old map
  bool replaces_ = false;
};

}  // namespace cluxel::mapping
