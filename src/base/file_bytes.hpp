// SPDX-License-Identifier: Apache-2.0
// Whole files in and out of memory; a file is written beside its place and moved there when it is whole.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace cluxel {

/// The bytes of a file, or of /dev/stdin and /dev/fd/N; InputError when it cannot be read, or is no regular file.
std::string readFile(const std::filesystem::path& path);

/// At most the first `count` bytes of a file; InputError when it cannot be read.
std::string readBeginning(const std::filesystem::path& path, std::size_t count);

/// Whether something is there, or may be: of what may not be looked at, opening it tells why.
bool mayBeThere(const std::filesystem::path& path);

/// The entries of a folder whose names end in one of `endings`, sorted; InputError when it cannot be read.
std::vector<std::filesystem::path> filesIn(const std::filesystem::path& folder,
                                           const std::vector<std::string_view>& endings);

/// Writes all of `bytes` or leaves the old file as it was; Error (StoreUnavailable) when the disk refuses. A link stays
/// a link: the file that it leads to is replaced. What is no file (a pipe, a device) is written to in place.
void writeFile(const std::filesystem::path& path, std::string_view bytes);

/// Where a symbolic link, or a chain of them, leads to, be there something or not; `path` itself when it is no link.
std::filesystem::path withoutLinks(std::filesystem::path path);

/// The folder of TMPDIR, or /tmp; Error (StoreUnavailable) when there is no such folder.
std::filesystem::path temporaryFolderPath();

/// Makes the disk keep that `file` was made, renamed or removed, as far as the system can.
void syncFolderOf(const std::filesystem::path& file);

}  // namespace cluxel
