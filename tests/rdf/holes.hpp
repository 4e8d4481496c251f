// SPDX-License-Identifier: Apache-2.0
// What files take on the disk, and whether they may have holes.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>

namespace cluxel::rdf {

/// What a file takes on the disk, without its holes.
inline std::uint64_t diskBytes(const std::filesystem::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) ADD_FAILURE() << "cannot examine " << file;
  return static_cast<std::uint64_t>(status.st_blocks) * 512;
}

/// Whether files in the folder may have holes; some file systems have none.
inline bool hasHoles(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "holes";
  constexpr off_t kBytes = 1 << 16;
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT, 0600);
  const bool has = ::ftruncate(descriptor, kBytes) == 0 &&
                   ::fallocate(descriptor, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, kBytes) == 0;
  ::close(descriptor);
  std::filesystem::remove(file);
  return has;
}

}  // namespace cluxel::rdf
