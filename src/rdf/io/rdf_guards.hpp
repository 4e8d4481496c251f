// SPDX-License-Identifier: Apache-2.0
// Refuses texts that crash raptor, or that it reads as others.
#pragma once

#include "rdf/io/rdf_text.hpp"

namespace cluxel::rdf {

/// Throws InputError with the location of invalid UTF-8, a zero or surrogate, also escaped, a statement of N-Triples or
/// N-Quads without a full stop, or input that is known to crash raptor 2.0.15. Of XML, which is kept in memory, the
/// whole text is one piece.
void refuseHostileText(const RdfSource& source, const RdfPiece& piece);

}  // namespace cluxel::rdf
