// SPDX-License-Identifier: Apache-2.0
// Where the program or library lies that holds this code, and modules that belong to it.
#pragma once

#include <filesystem>
#include <string>

namespace cluxel {

/// The program or shared library that contains this code, symbolic links resolved; empty when unknown.
std::filesystem::path ownBinary();

/// The module `name` that belongs to this program or library: in the folder `cluxel` of the installation's libraries,
/// or in the folder `modules` of the build. Throws Error (FaultyInput) when it is at neither place, or when it belongs
/// to another user than the program does: then it may have been planted.
std::filesystem::path ownModule(const std::string& name);

/// The same for a given program or library.
std::filesystem::path moduleOf(const std::filesystem::path& binary, const std::string& name);

}  // namespace cluxel
