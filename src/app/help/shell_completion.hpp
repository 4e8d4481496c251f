// SPDX-License-Identifier: Apache-2.0
// Scripts that complete commands and options in shells.
#pragma once

#include <string>

#include "app/command_table.hpp"

namespace cluxel::app {

/// Where neither a command nor an option can stand, files are completed.
std::string bashCompletion(const CommandEntry& program);
std::string zshCompletion(const CommandEntry& program);
std::string fishCompletion(const CommandEntry& program);

}  // namespace cluxel::app
