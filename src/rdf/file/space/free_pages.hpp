// SPDX-License-Identifier: Apache-2.0
// The pages of a map file that no commit uses any more, and their room on the disk.
#pragma once

#include <cstdint>

#include "rdf/file/environment.hpp"

namespace cluxel::rdf {

/// How many pages LMDB lists as free.
std::uint64_t freePageCount(const ReadTransaction& transaction);

/// Gives the disk space of free pages back to the file system. The file keeps its length; the pages are holes until a
/// change uses them again. Pages that an open snapshot reads stay, and so do runs of less than 16 KiB, which would
/// scatter the file. Does nothing where the file system has no holes, or the file has another name (a hard link),
/// because then not all readers are known. The environment must have been opened for writing. Throws MapBusy when
/// another process writes for more than 1.5 s. Returns how many bytes the free runs take. Cost: the list of free pages
/// is read, and one system call a run.
std::uint64_t releaseFreePages(Environment& environment);

}  // namespace cluxel::rdf
