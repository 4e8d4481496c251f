// SPDX-License-Identifier: Apache-2.0
// The library's messages begin with "[json.exception.type_error.304] "; their numbers are documented and stable.
#include "base/json/json_fault.hpp"

namespace cluxel {

namespace {

/// What stands after the last `word` of the text.
std::string after(const std::string& text, const std::string& word) {
  const std::size_t at = text.rfind(word);
  return at == std::string::npos ? "another value" : text.substr(at + word.size());
}

}  // namespace

std::string plainFault(const nlohmann::json::exception& fault) {
  constexpr int kWrongType = 302, kNoObject = 304, kNoList = 305, kShortList = 401, kNoKey = 403;
  const std::string text = fault.what();
  const std::size_t end = text.find("] ");
  const std::string own = text.starts_with('[') && end != std::string::npos ? text.substr(end + 2) : text;
  if (fault.id == kNoObject) return "there is " + after(own, " with ") + " where an object {…} is wanted";
  if (fault.id == kNoList) return "there is " + after(own, " with ") + " where a list […] is wanted";
  if (fault.id == kShortList) return "a list is too short";
  const std::size_t key = own.find("key '"), key_end = own.rfind("' not found");
  if (fault.id == kNoKey && key != std::string::npos && key_end != std::string::npos)
    return "it has no '" + own.substr(key + 5, key_end - key - 5) + "'";
  const std::size_t wanted = own.find("type must be "), found = own.find(", but is ");
  if (fault.id == kWrongType && wanted != std::string::npos && found != std::string::npos)
    return "there is " + own.substr(found + 9) + " where " + own.substr(wanted + 13, found - wanted - 13) +
           " is wanted";
  return own;
}

}  // namespace cluxel
