// SPDX-License-Identifier: Apache-2.0
// Which option of the program is the remedy that a library error names.
#pragma once

#include <filesystem>
#include <string>

#include "cluxel/error.hpp"

namespace cluxel::app {

/// The error's message; below it the option that helps, if there is one.
std::string messageOf(const Error& error);
/// For what no other error tells: the path, and why the system refuses it.
std::string messageOf(const std::filesystem::filesystem_error& error);

}  // namespace cluxel::app
