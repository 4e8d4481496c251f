// SPDX-License-Identifier: Apache-2.0
// The classes that rules may name, out of ontology texts.
#pragma once

#include <vector>

#include "cluxel/mapping/map_inputs.hpp"
#include "cluxel/reasoning/class_catalogue.hpp"

namespace cluxel {

/// Throws InputError with all faults of the texts.
ClassCatalogue classCatalogueOf(const std::vector<NamedText>& ontology);

}  // namespace cluxel
