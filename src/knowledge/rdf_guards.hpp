// SPDX-License-Identifier: Apache-2.0
// Texts that must not reach raptor.
#pragma once

#include "cluxel/knowledge/rdf_io.hpp"

namespace cluxel {

/// InputError at the place of bytes that no RDF text has, and of what raptor 2.0.15 is known to crash on.
void refuseHostileText(const RdfSource& source);

}  // namespace cluxel
