// SPDX-License-Identifier: Apache-2.0
// What `--version` prints.
#pragma once

#include <string>

namespace cluxel::app {

/// Version and commit; then what decides whether this program can use maps and models of another one: the map's format,
/// the version of the stages, and the hash of the features that models are trained on.
std::string versionText();

}  // namespace cluxel::app
