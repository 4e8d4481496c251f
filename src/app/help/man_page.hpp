// SPDX-License-Identifier: Apache-2.0
// The man page cluxel(1) in roff.
#pragma once

#include <string>

#include "app/command_table.hpp"

namespace cluxel::app {

/// `version` stands in the page's footer.
std::string manPage(const CommandEntry& program, const std::string& version);

}  // namespace cluxel::app
