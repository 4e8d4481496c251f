// SPDX-License-Identifier: Apache-2.0
// Relative IRIs against a base, after RFC 3986 section 5.
#pragma once

#include <string>
#include <string_view>

namespace cluxel {

/// True when `iri` begins with a scheme ("http:"), and so needs no base.
bool isAbsoluteIri(std::string_view iri);

/// `reference` against `base`, which must be absolute. An absolute reference is kept as it is, without normalisation
/// of its path, as Turtle parsers keep it; then names in queries and in data are the same.
std::string resolveIri(std::string_view reference, std::string_view base);

}  // namespace cluxel
