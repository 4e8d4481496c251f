// SPDX-License-Identifier: Apache-2.0
// Marks as open file description locks, which the system drops with the process.
#include "rdf/file/opening/joint_use.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>

#include "rdf/file/forks.hpp"

namespace cluxel::rdf {

namespace {

/// Behind the byte of NameLock.
constexpr off_t kFirstMark = (off_t{1} << 61) + 1;
constexpr off_t kMarks = off_t{1} << 60;

/// On NFS and SMB, flock() locks all bytes of a file, these too.
bool keepsLocksApart(int descriptor) {
  constexpr std::array<std::uint32_t, 4> kNetwork{0x6969, 0x517B, 0xFF534D42, 0xFE534D42};
  struct statfs system {};
  if (::fstatfs(descriptor, &system) != 0) return false;
  return std::find(kNetwork.begin(), kNetwork.end(), static_cast<std::uint32_t>(system.f_type)) == kNetwork.end();
}

/// The files of one file system have different marks. 0 when the file cannot be examined.
off_t markOf(int descriptor) {
  struct stat status {};
  if (!keepsLocksApart(descriptor) || ::fstat(descriptor, &status) != 0) return 0;
  constexpr std::uint64_t kSpread = 0x9E3779B97F4A7C15;  // file systems number their files alike
  const std::uint64_t number = std::uint64_t{status.st_dev} * kSpread + std::uint64_t{status.st_ino};
  return kFirstMark + static_cast<off_t>(number % static_cast<std::uint64_t>(kMarks));
}

struct flock bytesAt(off_t first, off_t count, short kind) {
  struct flock range {};
  range.l_type = kind;
  range.l_whence = SEEK_SET;
  range.l_start = first;
  range.l_len = count;
  return range;
}

bool change(int descriptor, off_t mark, short kind) {
  struct flock range = bytesAt(mark, 1, kind);
  int code = 0;
  do code = ::fcntl(descriptor, F_OFD_SETLK, &range);
  while (code != 0 && errno == EINTR);
  return code == 0;
}

/// Whether another descriptor has a mark there.
bool isMarked(int descriptor, off_t first, off_t count) {
  if (count <= 0) return false;
  struct flock range = bytesAt(first, count, F_WRLCK);
  return ::fcntl(descriptor, F_OFD_GETLK, &range) == 0 && range.l_type != F_UNLCK;
}

bool isMarkedBeside(int descriptor, off_t mark) {
  if (mark == 0) return false;
  return isMarked(descriptor, kFirstMark, mark - kFirstMark) ||
         isMarked(descriptor, mark + 1, kFirstMark + kMarks - mark - 1);
}

}  // namespace

JointUse::JointUse(int map, Descriptor lock_file) : map_(map), lock_file_(std::move(lock_file)), forks_(forkCount()) {
  closeInChildren(lock_file_.get());
  const off_t map_mark = markOf(lock_file_.get()), lock_mark = markOf(map_);
  if (map_mark == 0 || lock_mark == 0) return;
  if (change(map_, map_mark, F_RDLCK)) map_mark_ = map_mark;
  if (change(lock_file_.get(), lock_mark, F_RDLCK)) lock_mark_ = lock_mark;
}

JointUse::~JointUse() {
  if (forks_ != forkCount()) {  // closed already
    static_cast<void>(lock_file_.release());
    return;
  }
  keepInChildren(lock_file_.get());
  if (map_mark_ != 0) change(map_, map_mark_, F_UNLCK);
}

bool JointUse::isLockFileOfOthers() const {
  return isMarkedBeside(lock_file_.get(), lock_mark_);
}

bool JointUse::hasCompany() const {
  return map_mark_ == 0 || isMarked(map_, map_mark_, 1);
}

bool JointUse::hasOtherLockFiles() const {
  return isMarkedBeside(map_, map_mark_);
}

}  // namespace cluxel::rdf
