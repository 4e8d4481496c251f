// SPDX-License-Identifier: Apache-2.0
// Whether what names scans can be read: files, folders, manifests and the entries of manifests.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/yaml/fault_list.hpp"
#include "scan/formats/manifest.hpp"

namespace cluxel::scan {

bool isManifest(const std::filesystem::path& path);

/// The manifest that speaks for a folder.
std::optional<std::filesystem::path> manifestIn(const std::filesystem::path& folder);

/// Throws InputError when `input` is not there, may not be read, or is neither a file nor a folder.
void requireInput(const std::filesystem::path& input);

/// Adds a fault, at its place in the manifest, for each path that cannot be read or may not be listed.
void checkPaths(const Manifest& manifest, FaultList& faults);

}  // namespace cluxel::scan
