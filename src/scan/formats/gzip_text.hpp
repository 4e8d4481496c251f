// SPDX-License-Identifier: Apache-2.0
// Text that may be compressed with gzip.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace cluxel::scan {

/// The text itself, or what it unpacks to when it begins as gzip does. Throws InputError naming the byte when
/// the data are damaged or cut off, and when they unpack to more than `max_bytes`.
std::string unpackedText(std::string_view bytes, const std::string& file, std::size_t max_bytes);

}  // namespace cluxel::scan
