// SPDX-License-Identifier: Apache-2.0
// Messages for wrong command lines: the nearest known name, and where help is.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace cluxel::app {

/// For a command line that `app` refused with `fault`.
std::string usageMessage(const CLI::App& app, const CLI::ParseError& fault);

/// The words with commas between them.
std::string listed(const std::vector<std::string>& words);

}  // namespace cluxel::app
