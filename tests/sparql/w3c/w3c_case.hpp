// SPDX-License-Identifier: Apache-2.0
// Runs one test of the W3C suites.
#pragma once

#include <string>

#include "sparql/w3c/w3c_manifest.hpp"

namespace cluxel::test {

/// Empty when the test passes, else the reason of the failure.
std::string runCase(const W3cFolder& folder, const W3cCase& test);

/// The same by the program alone: `load` makes the store, `query` or `update` runs the request, `dump` shows the store.
/// `scratch` is a folder for its files.
std::string runCaseByProgram(const std::filesystem::path& program, const std::filesystem::path& scratch,
                             const W3cFolder& folder, const W3cCase& test);

}  // namespace cluxel::test
