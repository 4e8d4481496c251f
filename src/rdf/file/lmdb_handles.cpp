// SPDX-License-Identifier: Apache-2.0
// Error messages for LMDB's and the system's error codes.
#include "rdf/file/lmdb_handles.hpp"

#include <cerrno>
#include <string>

#include "cluxel/error.hpp"
#include "rdf/file/map_replacement.hpp"

namespace cluxel::rdf {

namespace {

constexpr std::string_view kDamaged =
    "the map is damaged; run `cluxel doctor` for the location, restore a copy, or remove the file and build it again";

std::string explain(int code, std::string_view doing) {
  const std::string attempt = "cannot " + std::string(doing) + ": ";
  switch (code) {
    case MDB_INVALID:
      return "is not a Cluxel map";
    case MDB_VERSION_MISMATCH:
      return "has another data format of LMDB; open it with the program that wrote it";
    case MDB_CORRUPTED:
    case MDB_PAGE_NOTFOUND:
    case MDB_PANIC:
      return attempt + std::string(kDamaged);
    case MDB_MAP_FULL:
    case MDB_MAP_RESIZED:
    case ENOMEM:
      return attempt +
             "no address space is left; raise the limit (ulimit -v): each map, also a temporary one, reserves address "
             "space for the file and its growth";
    case MDB_READERS_FULL:
      return attempt + "too many readers are at work; wait for some to end";
    case EIO:  // LMDB reports a short write as EIO
    case ENOSPC:
    case EFBIG:
    case EDQUOT:
      return attempt + "no space is left on the disk, the file may not become larger (ulimit -f), or the disk fails";
    case EROFS:
      return attempt + "the file system is read-only; write to another one, or mount it for writing";
    case EACCES:
    case EPERM:
      return attempt + "permission denied; check the rights of the file and its folder";
    case ENOENT:
      return attempt + "there is no such file";
    default:
      return attempt + mdb_strerror(code);
  }
}

}  // namespace

void failStore(const std::filesystem::path& file, int code, std::string_view doing) {
  if (code == EIO || code == ENOSPC || code == EFBIG || code == EDQUOT)
    throw NoSpaceLeft(file.string() + ": " + explain(code, doing));
  throw Error(ErrorKind::StoreUnavailable, file.string() + ": " + explain(code, doing));
}

}  // namespace cluxel::rdf
