// SPDX-License-Identifier: Apache-2.0
// Registers Cluxel maps as the librdf storage "cluxel".
#pragma once

#include <memory>
#include <optional>

#include "rdf/file/environment.hpp"

struct librdf_world_s;
struct librdf_storage_s;

namespace cluxel::rdf {

/// Registers the storage "cluxel" in a world. The storage's name is the map file. Options: new='yes' creates a map,
/// which must not exist; write='no' opens read-only; strict='yes' makes the default graph the unnamed graph instead of
/// the union of all graphs but history. Use one world per thread. Each change outside a transaction is a commit of its
/// own, so add streams or use transactions.
void registerRedlandStorage(librdf_world_s* world);

}  // namespace cluxel::rdf
