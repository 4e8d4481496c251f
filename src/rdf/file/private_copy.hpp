// SPDX-License-Identifier: Apache-2.0
// A copy of a map for a reader that cannot register in the lock file: without that, a writer reuses the pages it reads.
#pragma once

#include <filesystem>

#include "rdf/file/file_guards.hpp"

namespace cluxel::rdf {

/// The copy in a temporary folder, which is removed with this object.
class PrivateCopy {
 public:
  /// Copies the last commit of `map`, open as `descriptor`. A writer that would begin meanwhile
  /// gets MapBusy when the copy takes long; one that has begun goes on, and
  /// when it commits, the copy is made again. Throws MapBusy when commits follow each other too fast; Error
  /// (StoreUnavailable) when the temporary folder has no room.
  PrivateCopy(const std::filesystem::path& map, int descriptor);

  const std::filesystem::path& file() const { return file_; }
  Descriptor takeDescriptor() { return std::move(copy_); }

 private:
  TemporaryFolder folder_;
  std::filesystem::path file_;
  Descriptor copy_;
};

}  // namespace cluxel::rdf
