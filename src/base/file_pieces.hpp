// SPDX-License-Identifier: Apache-2.0
// Writes a file piece by piece.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace cluxel {

/// As writeFile(), for contents that need not fit into memory: `fill` is called once, with a function that takes the
/// next piece. When it throws, the old file stays.
void writeFileInPieces(const std::filesystem::path& path,
                       const std::function<void(const std::function<void(std::string_view)>& take)>& fill);

}  // namespace cluxel
