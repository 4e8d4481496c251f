// SPDX-License-Identifier: Apache-2.0
// The storage as a module that librdf loads itself from REDLAND_MODULE_PATH: it calls this one function.
#include "cluxel/knowledge/redland_storage.hpp"

extern "C" __attribute__((visibility("default"))) void librdf_storage_module_register_factory(librdf_world_s* world);

extern "C" void librdf_storage_module_register_factory(librdf_world_s* world) {
  cluxel::registerRedlandStorage(world);
}
