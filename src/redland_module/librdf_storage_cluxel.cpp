// SPDX-License-Identifier: Apache-2.0
// Entry point of the loadable storage module: librdf loads it from REDLAND_MODULE_PATH and calls this function.
#include "rdf/redland/redland_storage.hpp"

extern "C" __attribute__((visibility("default"))) void librdf_storage_module_register_factory(librdf_world_s* world);

extern "C" void librdf_storage_module_register_factory(librdf_world_s* world) {
  cluxel::rdf::registerRedlandStorage(world);
}
