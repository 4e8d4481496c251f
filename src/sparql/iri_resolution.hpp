// SPDX-License-Identifier: Apache-2.0
// Relative IRIs against a base, after RFC 3986 section 5.
#pragma once

#include <string>
#include <string_view>

namespace cluxel {

/// True when `iri` begins with a scheme ("http:"), and so needs no base.
bool isAbsoluteIri(std::string_view iri);

/// `reference` against `base`, which must be absolute unless the reference is. Dot segments are removed from absolute
/// references too, but nothing else is normalised: raptor reads data so, and names must be the same in both.
std::string resolveIri(std::string_view reference, std::string_view base);

}  // namespace cluxel
