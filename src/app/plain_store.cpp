// SPDX-License-Identifier: Apache-2.0
// Tells stores from maps.
#include "app/plain_store.hpp"

#include "mapping/map_state.hpp"
#include "rdf/store/environment.hpp"

namespace cluxel::app {

std::optional<rdf::QuadReader> storeWithoutScans(const std::filesystem::path& file) {
  const rdf::ReadTransaction transaction = rdf::Environment::open(file, rdf::OpenMode::ReadOnly)->read();
  if (mapping::storedState(transaction)) return std::nullopt;
  rdf::QuadReader quads(transaction);
  if (quads.size() == 0) return std::nullopt;
  return quads;
}

}  // namespace cluxel::app
