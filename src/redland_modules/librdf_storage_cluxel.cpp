// SPDX-License-Identifier: Apache-2.0
// The storage and the query languages as a module that librdf loads itself from REDLAND_MODULE_PATH: it calls this one
// function. (librdf looks for storage modules only; so the query languages come with the storage.)
#include "cluxel/knowledge/redland_storage.hpp"
#include "cluxel/sparql/redland_query.hpp"

extern "C" __attribute__((visibility("default"))) void librdf_storage_module_register_factory(librdf_world_s* world);

extern "C" void librdf_storage_module_register_factory(librdf_world_s* world) {
  cluxel::registerRedlandStorage(world);
  cluxel::registerRedlandQueries(world);
}
