// SPDX-License-Identifier: Apache-2.0
// "Did you mean": the known name that is closest to a mistyped one.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace cluxel {

/// Number of insertions, deletions, replacements and swaps of neighbours that turn `a` into `b`. Cost O(|a||b|).
std::size_t editDistance(std::string_view a, std::string_view b);

/// The known name nearest to `name` when it is near enough to be a slip (a third of its length, at least 1); ties go
/// to the first. Case is ignored.
std::optional<std::string> nearestName(std::string_view name, std::span<const std::string> known);

/// "did you mean 'x'?", or "known: a, b, c" when nothing is near and the list is short, or empty.
std::string suggestion(std::string_view name, std::span<const std::string> known);

}  // namespace cluxel
