// SPDX-License-Identifier: Apache-2.0
// A copy of a map for a reader that cannot register in the lock file: without that, a writer reuses the pages it reads.
#pragma once

#include <filesystem>

#include "rdf/store/file_guards.hpp"

namespace cluxel::rdf {

/// The copy in a folder that only this user can open. The folder is removed with this object; open descriptors keep
/// the data.
class PrivateCopy {
 public:
  /// Copies the last commit of `map`, open as `descriptor`, while no process writes. Throws MapBusy when a writer does
  /// not end within 1.5 s; Error (StoreUnavailable) when the temporary folder has no room.
  PrivateCopy(const std::filesystem::path& map, int descriptor);
  PrivateCopy(const PrivateCopy&) = delete;
  PrivateCopy& operator=(const PrivateCopy&) = delete;
  ~PrivateCopy();

  const std::filesystem::path& file() const { return file_; }
  Descriptor takeDescriptor() { return std::move(copy_); }

 private:
  std::filesystem::path folder_, file_;
  Descriptor copy_;
};

}  // namespace cluxel::rdf
