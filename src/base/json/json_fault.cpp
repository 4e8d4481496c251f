// SPDX-License-Identifier: Apache-2.0
// The library's messages begin with "[json.exception.type_error.304] "; their numbers are documented and stable.
#include "base/json/json_fault.hpp"

namespace cluxel {

namespace {

/// The library's name of a type in plain words.
std::string plainType(const std::string& type) {
  if (type == "number") return "a number";
  if (type == "string") return "a text";
  if (type == "array") return "a list";
  if (type == "object") return "an object";
  if (type == "boolean") return "true or false";
  return type == "null" ? type : "another value";
}

/// The type that stands after the last `word` of the text.
std::string typeAfter(const std::string& text, const std::string& word) {
  const std::size_t at = text.rfind(word);
  return plainType(at == std::string::npos ? "" : text.substr(at + word.size()));
}

/// at() throws the same fault for a name and for a number.
std::string wantedInstead(const std::string& text) {
  if (text.ends_with(" with array")) return "an object {…}";
  return text.ends_with(" with object") ? "a list […]" : "an object {…} or a list […]";
}

}  // namespace

std::string plainFault(const nlohmann::json::exception& fault) {
  constexpr int kWrongType = 302, kNoObject = 304, kNoList = 305, kShortList = 401, kNoKey = 403;
  const std::string text = fault.what();
  const std::size_t end = text.find("] ");
  const std::string own = text.starts_with('[') && end != std::string::npos ? text.substr(end + 2) : text;
  if (fault.id == kNoObject)
    return "there is " + typeAfter(own, " with ") + " where " + wantedInstead(own) + " is wanted";
  if (fault.id == kNoList) return "there is " + typeAfter(own, " with ") + " where a list […] is wanted";
  if (fault.id == kShortList) return "a list is too short";
  const std::size_t key = own.find("key '"), key_end = own.rfind("' not found");
  if (fault.id == kNoKey && key != std::string::npos && key_end != std::string::npos)
    return "it has no '" + own.substr(key + 5, key_end - key - 5) + "'";
  const std::size_t wanted = own.find("type must be "), found = own.find(", but is ");
  if (fault.id == kWrongType && wanted != std::string::npos && found != std::string::npos)
    return "there is " + plainType(own.substr(found + 9)) + " where " +
           plainType(own.substr(wanted + 13, found - wanted - 13)) + " is wanted";
  return own;
}

}  // namespace cluxel
