// SPDX-License-Identifier: Apache-2.0
// Resolves relative IRIs by RFC 3986 section 5.
#pragma once

#include <string>
#include <string_view>

namespace cluxel::sparql {

/// True when `iri` has a scheme ("http:") and needs no base.
bool isAbsoluteIri(std::string_view iri);

/// Resolves `reference` against `base`, which must be absolute unless the reference is. Dot segments are removed from
/// absolute references too; nothing else is normalised. The readers of RDF do the same, and IRIs in queries
/// and data must agree.
std::string resolveIri(std::string_view reference, std::string_view base);

}  // namespace cluxel::sparql
