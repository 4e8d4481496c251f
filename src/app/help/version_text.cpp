// SPDX-License-Identifier: Apache-2.0
// CMake gives CLUXEL_COMMIT to this file only, so that a commit recompiles nothing else.
#include "app/help/version_text.hpp"

#include "mapping/map_inputs.hpp"
#include "perception/features/feature_tile.hpp"
#include "perception/training/training_files.hpp"
#include "rdf/file/map_check.hpp"

#ifndef CLUXEL_COMMIT
#define CLUXEL_COMMIT "unknown"
#endif

namespace cluxel::app {

std::string versionText() {
  const ContentHash features = perception::featureLayout(perception::portablePerception().features).hash();
  return "cluxel " CLUXEL_VERSION " (commit " CLUXEL_COMMIT ")\nmap format " + std::to_string(rdf::kMapFormat) +
         ", stages " + std::to_string(mapping::kStagesVersion) + ", features " + features.hex().substr(0, 16);
}

}  // namespace cluxel::app
