// SPDX-License-Identifier: Apache-2.0
// The free space of a map: given back after a change that left much of it, and on request.
#pragma once

#include <cstdint>
#include <filesystem>

#include "cluxel/progress.hpp"
#include "rdf/file/space/layer_sizes.hpp"

namespace cluxel::mapping {

/// The bytes of a file before and after.
struct CompactedBytes {
  std::uint64_t before = 0, after = 0;
};

/// Rewrites a map without free pages, and with full index pages when `pages` is Filled. The copy replaces it by a
/// rename. Readers continue with the old file. The new file has the owner, group and rights of the old one. Takes the
/// build lock; other writers wait or are refused. Throws Error (StoreUnavailable) when the map is damaged, cannot be
/// written, or has another name (a hard link); it is then as before.
CompactedBytes compactMap(const std::filesystem::path& map, rdf::CopiedPages pages = rdf::CopiedPages::Filled);

/// Writes the same to a file that is not there yet; the map is only read. What a killed command left is not copied.
/// Throws Error (StoreUnavailable), also for a first build that was killed before its first commit; a part of the copy
/// may be left then.
CompactedBytes copyCompacted(const std::filesystem::path& map, const std::filesystem::path& copy);

/// After a build or a merge.
inline constexpr double kMaxFreeShare = 0.05;
/// After a change: the next change uses the free pages, and a rewrite after each would cost more than the change.
inline constexpr double kMaxFreeShareOfChanged = 0.25;
/// Of what the map takes on the disk, after a change. In a map of more than 96 MiB half-filled pages of indexes come on
/// top.
inline constexpr double kMaxFreeShareOfDisk = 0.01;

/// Compacts a map when that frees more than this share of it, and more than a mebibyte. So the cost follows the
/// changes that left the space. Pages of indexes are filled when that alone would free as much. A map of up to 96 MiB
/// is compacted, with full pages, also when half-filled ones take more than kMaxFreeShare of what is in use. Where it
/// fails, the map stays larger, and a note tells why.
void compactIfSparse(const std::filesystem::path& map, ProgressSink& sink, double max_free_share = kMaxFreeShare);
enum class Compaction : std::uint8_t { NotNeeded, Done, Failed };
/// The same when what it would free is known.
Compaction compactIfSparse(const std::filesystem::path& map, const rdf::FreeSpace& space, ProgressSink& sink,
                           double max_free_share);

/// After a change: compacts the map when more than kMaxFreeShareOfChanged would be freed. Else, or where that fails,
/// free pages that take more than kMaxFreeShareOfDisk of what the map takes on the disk become holes in the file, if
/// the file system can.
void freeSpaceOfChange(const std::filesystem::path& map, ProgressSink& sink);
/// The same when the free space is known.
void freeSpaceOfChange(const std::filesystem::path& map, const rdf::FreeSpace& space, ProgressSink& sink);

/// Removes the copy that a killed compaction has left beside the map, and does what freeSpaceOfChange() does.
void finishCompaction(const std::filesystem::path& map, ProgressSink& sink);

}  // namespace cluxel::mapping
