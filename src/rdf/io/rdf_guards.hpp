// SPDX-License-Identifier: Apache-2.0
// Refuses texts that crash raptor.
#pragma once

#include "rdf/io/rdf_io.hpp"

namespace cluxel::rdf {

/// Throws InputError with the location of invalid UTF-8, a zero byte, or input that is known to crash raptor 2.0.15.
void refuseHostileText(const RdfSource& source);

}  // namespace cluxel::rdf
