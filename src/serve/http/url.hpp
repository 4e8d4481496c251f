// SPDX-License-Identifier: Apache-2.0
// Paths, query strings and forms of URLs.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cluxel::serve {

/// Names and values in the order in which they were sent; a name may stand there more than once.
using Parameters = std::vector<std::pair<std::string, std::string>>;

/// A request target, decoded.
struct Target {
  std::vector<std::string> segments;  ///< of the path; empty ones are left out
  bool has_query = false;             ///< a "?" is there
  Parameters parameters;
};

/// Throws Refusal (400) for a malformed escape.
Target parseTarget(std::string_view target);
/// A query string or a body of type application/x-www-form-urlencoded. Throws Refusal (400) for a malformed escape.
Parameters parseForm(std::string_view text);

/// All values of a name.
std::vector<std::string> valuesOf(const Parameters& parameters, std::string_view name);
/// The value of a name that may be given once; none when it is absent. Throws Refusal (400) when it is there twice.
std::optional<std::string> valueOf(const Parameters& parameters, std::string_view name);
/// The value as a finite number; Refusal (400) when it is none.
std::optional<double> numberOf(const Parameters& parameters, std::string_view name);
/// The value as a whole number; Refusal (400) when it is none.
std::optional<std::size_t> wholeNumberOf(const Parameters& parameters, std::string_view name);
/// Numbers separated by commas. Throws Refusal (400) for another text.
std::vector<double> numbersIn(std::string_view name, std::string_view text);
/// Throws Refusal (400) for a parameter that is not among `known`.
void requireKnown(const Parameters& parameters, const std::vector<std::string>& known);

}  // namespace cluxel::serve
