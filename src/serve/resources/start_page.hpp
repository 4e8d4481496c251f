// SPDX-License-Identifier: Apache-2.0
// A plain HTML page that lists what the service answers.
#pragma once

#include <string>
#include <vector>

#include "serve/http/http_message.hpp"

namespace cluxel::serve {

/// Without scripts; names are text, never markup.
HttpResponse startPage(const std::vector<std::string>& map_names);

/// Escapes `text` for HTML.
std::string htmlText(std::string_view text);

}  // namespace cluxel::serve
