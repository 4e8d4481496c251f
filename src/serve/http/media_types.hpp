// SPDX-License-Identifier: Apache-2.0
// Content negotiation (RFC 9110, section 12): which of the offered media types a client takes.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cluxel::serve {

/// The place in `offers` of the type that the header Accept values most; none when it takes none of them. The most
/// specific range that matches an offer gives its quality. Among equal ones the first offer is taken. An absent header
/// accepts every type.
std::optional<std::size_t> negotiate(std::string_view accept, const std::vector<std::string>& offers);

/// The type alone, in lower case: "text/turtle" of "Text/Turtle; charset=utf-8".
std::string mediaTypeOf(std::string_view content_type);
/// The value of charset in lower case; empty when there is none.
std::string charsetOf(std::string_view content_type);

}  // namespace cluxel::serve
