// SPDX-License-Identifier: Apache-2.0
// Fields of CSV (RFC 4180).
#pragma once

#include <string>

namespace cluxel {

/// In quotes where the text needs them.
inline std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace cluxel
