// SPDX-License-Identifier: Apache-2.0
// Makes two symbolic links in a temporary folder, to the links of /proc.
#include "rdf/file/opening/descriptor_names.hpp"

#include <string>
#include <system_error>

#include "rdf/file/lock_file.hpp"

namespace cluxel::rdf {

namespace fs = std::filesystem;

namespace {

/// False also where /proc is that of other processes, as in some containers.
bool link(int descriptor, const fs::path& name) {
  std::error_code failure;
  fs::create_symlink(nameOfDescriptor(descriptor), name, failure);
  return !failure && isNamed(identityOf(descriptor, name), name);
}

}  // namespace

fs::path nameOfDescriptor(int descriptor) {
  return "/proc/self/fd/" + std::to_string(descriptor);
}

DescriptorNames::DescriptorNames(int map, int lock_file) {
  std::error_code failure;
  const fs::path usual = fs::temp_directory_path(failure);
  if (!failure && linkIn(usual, map, lock_file)) return;
  linkIn("/dev/shm", map, lock_file);  // TMPDIR may be full, or not there
}

bool DescriptorNames::linkIn(const fs::path& parent, int map, int lock_file) {
  folder_ = std::make_unique<TemporaryFolder>(parent);
  if (folder_->path().empty()) return false;
  const fs::path name = folder_->path() / "map";
  if (!link(map, name) || !link(lock_file, lockFileOf(name))) return false;
  map_ = name;
  return true;
}

}  // namespace cluxel::rdf
