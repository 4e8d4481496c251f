// SPDX-License-Identifier: Apache-2.0
// Decoding of URLs and forms.
#include "serve/http/url.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/nearest_name.hpp"
#include "serve/http/refusal.hpp"

namespace cluxel::serve {

namespace {

std::optional<int> hexValue(char digit) {
  if (digit >= '0' && digit <= '9') return digit - '0';
  if (digit >= 'a' && digit <= 'f') return digit - 'a' + 10;
  if (digit >= 'A' && digit <= 'F') return digit - 'A' + 10;
  return std::nullopt;
}

std::string decoded(std::string_view text, bool plus_is_space) {
  std::string plain;
  plain.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      plain += plus_is_space && text[i] == '+' ? ' ' : text[i];
      continue;
    }
    const auto high = i + 2 < text.size() ? hexValue(text[i + 1]) : std::nullopt;
    const auto low = i + 2 < text.size() ? hexValue(text[i + 2]) : std::nullopt;
    if (!high || !low)
      throw Refusal(400, "the URL or form holds a '%' without two hexadecimal digits; write a percent sign as %25");
    plain += static_cast<char>(*high * 16 + *low);
    i += 2;
  }
  return plain;
}

template <typename Visit>
void splitAt(std::string_view text, char separator, const Visit& visit) {
  while (true) {
    const std::size_t cut = text.find(separator);
    visit(text.substr(0, cut));
    if (cut == std::string_view::npos) return;
    text.remove_prefix(cut + 1);
  }
}

template <typename Number>
Number readNumber(std::string_view name, std::string_view text, const char* expected) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size())
    throw Refusal(400, "parameter " + std::string(name) + ": write " + expected + ", not '" + std::string(text) + "'");
  return value;
}

double readFinite(std::string_view name, std::string_view text) {
  const auto value = readNumber<double>(name, text, "a number with a point");
  if (!std::isfinite(value)) throw Refusal(400, "parameter " + std::string(name) + ": write a finite number");
  return value;
}

}  // namespace

Parameters parseForm(std::string_view text) {
  Parameters parameters;
  splitAt(text, '&', [&](std::string_view pair) {
    if (pair.empty()) return;
    const std::size_t cut = pair.find('=');
    const std::string_view value = cut == std::string_view::npos ? std::string_view() : pair.substr(cut + 1);
    parameters.emplace_back(decoded(pair.substr(0, cut), true), decoded(value, true));
  });
  return parameters;
}

Target parseTarget(std::string_view text) {
  Target target;
  text = text.substr(0, text.find('#'));
  const std::size_t cut = text.find('?');
  splitAt(text.substr(0, cut), '/', [&](std::string_view segment) {
    if (!segment.empty()) target.segments.push_back(decoded(segment, false));
  });
  target.has_query = cut != std::string_view::npos;
  if (target.has_query) target.parameters = parseForm(text.substr(cut + 1));
  return target;
}

std::vector<std::string> valuesOf(const Parameters& parameters, std::string_view name) {
  std::vector<std::string> values;
  for (const auto& [key, value] : parameters)
    if (key == name) values.push_back(value);
  return values;
}

std::optional<std::string> valueOf(const Parameters& parameters, std::string_view name) {
  const std::vector<std::string> values = valuesOf(parameters, name);
  if (values.size() > 1) throw Refusal(400, "parameter " + std::string(name) + ": it is given more than once");
  return values.empty() ? std::nullopt : std::optional(values.front());
}

std::optional<double> numberOf(const Parameters& parameters, std::string_view name) {
  const auto text = valueOf(parameters, name);
  return text ? std::optional(readFinite(name, *text)) : std::nullopt;
}

std::optional<std::size_t> wholeNumberOf(const Parameters& parameters, std::string_view name) {
  const auto text = valueOf(parameters, name);
  return text ? std::optional(readNumber<std::size_t>(name, *text, "a whole number")) : std::nullopt;
}

std::vector<double> numbersIn(std::string_view name, std::string_view text) {
  std::vector<double> numbers;
  splitAt(text, ',', [&](std::string_view part) { numbers.push_back(readFinite(name, part)); });
  return numbers;
}

void requireKnown(const Parameters& parameters, const std::vector<std::string>& known) {
  for (const auto& [name, value] : parameters) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string hint = suggestion(name, known);
    throw Refusal(400, "there is no parameter '" + name + "' here" + (hint.empty() ? "" : "; " + hint));
  }
}

}  // namespace cluxel::serve
