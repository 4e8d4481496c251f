// SPDX-License-Identifier: Apache-2.0
// Whole files in and out of memory; a file is written beside its place and moved there when it is whole.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace cluxel {

/// The bytes of a file; InputError naming the file when it cannot be read or is a folder.
std::string readFile(const std::filesystem::path& path);

/// Writes all of `bytes` or leaves the old file as it was; Error (StoreUnavailable) when the disk refuses.
void writeFile(const std::filesystem::path& path, std::string_view bytes);

}  // namespace cluxel
