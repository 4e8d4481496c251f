// SPDX-License-Identifier: Apache-2.0
// Lets LMDB, which opens files by name only, open the very files that this process has open already.
#pragma once

#include <filesystem>
#include <memory>

#include "rdf/file/file_guards.hpp"

namespace cluxel::rdf {

/// A name of an open file that stays right when the file is renamed or removed: a link of /proc. LMDB makes a file that
/// is not there, so a map that is moved away in the moment of opening would be followed by an empty one. Through such
/// a name it can make none.
std::filesystem::path nameOfDescriptor(int descriptor);

/// A map and its lock file under names that belong together as LMDB expects it. They end with this object; what LMDB
/// has opened stays open.
class DescriptorNames {
 public:
  DescriptorNames(int map, int lock_file);
  /// The name of the map. Empty where there is no /proc, or no temporary folder has room for two links.
  const std::filesystem::path& map() const { return map_; }

 private:
  bool linkIn(const std::filesystem::path& parent, int map, int lock_file);

  std::unique_ptr<TemporaryFolder> folder_;
  std::filesystem::path map_;
};

}  // namespace cluxel::rdf
