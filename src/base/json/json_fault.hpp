// SPDX-License-Identifier: Apache-2.0
// What is wrong with a JSON text, in plain words instead of those of the JSON library.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace cluxel {

/// "it has no 'name'", "a list is too short", "there is a number where a text is wanted".
std::string plainFault(const nlohmann::json::exception& fault);

}  // namespace cluxel
