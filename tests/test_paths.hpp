// SPDX-License-Identifier: Apache-2.0
// Where the checkout, its build and data from outside lie. Only test_paths.cpp knows, so that the others compile alike
// in every checkout and share one compiler cache.
#pragma once

#include <filesystem>

namespace cluxel::test {

std::filesystem::path sourceFolder();
std::filesystem::path buildFolder();

/// $CLUXEL_DATA, else ../shared/data beside the checkout; it may be absent.
std::filesystem::path outsideDataFolder();

}  // namespace cluxel::test
