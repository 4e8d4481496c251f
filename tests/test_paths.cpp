// SPDX-License-Identifier: Apache-2.0
// Paths of this checkout, from the build's definitions.
#include "test_paths.hpp"

#include <cstdlib>

namespace cluxel::test {

std::filesystem::path sourceFolder() {
  return CLUXEL_SOURCE_DIR;
}

std::filesystem::path buildFolder() {
  return CLUXEL_BINARY_DIR;
}

std::filesystem::path outsideDataFolder() {
  const char* given = std::getenv("CLUXEL_DATA");
  return given != nullptr ? std::filesystem::path(given) : sourceFolder() / "../shared/data";
}

}  // namespace cluxel::test
