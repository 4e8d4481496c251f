// SPDX-License-Identifier: Apache-2.0
// Checking that a text is UTF-8.
#pragma once

#include <optional>
#include <string_view>

namespace cluxel {

/// The place of the first byte that no valid UTF-8 text has there: overlong forms, surrogates and values
/// above U+10FFFF are invalid.
std::optional<std::size_t> firstInvalidUtf8(std::string_view text);

}  // namespace cluxel
