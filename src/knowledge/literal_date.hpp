// SPDX-License-Identifier: Apache-2.0
// xsd:dateTime and xsd:date as microseconds since 1970-01-01T00:00:00Z; none without a time zone.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace cluxel {

std::optional<std::int64_t> parseDateTime(std::string_view lexical);
std::optional<std::int64_t> parseDate(std::string_view lexical);  ///< the moment at which the day begins

}  // namespace cluxel
