// SPDX-License-Identifier: Apache-2.0
// Cluxel's SPARQL engine as query languages of Redland.
#pragma once

struct librdf_world_s;

namespace cluxel {

/// Makes the query languages "cluxel" and "sparql11" (SPARQL 1.1 Query) and "cluxel-update" (SPARQL 1.1 Update, which
/// writes the operator graph) known to a world: librdf_new_query(world, "cluxel", …). A model over the storage "cluxel"
/// is asked in place; the statements of any other model are copied first. False, and nothing registered, when this
/// librdf is not the release whose layout is known (1.0.17).
bool registerRedlandQueries(librdf_world_s* world);

}  // namespace cluxel
