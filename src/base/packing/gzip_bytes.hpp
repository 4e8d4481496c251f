// SPDX-License-Identifier: Apache-2.0
// gzip compression of bytes in memory.
#pragma once

#include <string>
#include <string_view>

namespace cluxel {

/// The bytes as gzip (RFC 1952) without time and name, so that equal bytes give equal results. Throws Error
/// (BudgetExceeded) for 4 GiB or more, and when memory is short.
std::string gzipped(std::string_view bytes);

}  // namespace cluxel
