// SPDX-License-Identifier: Apache-2.0
// Positions on the ground in Python: as arguments and as arrays.
#pragma once

#include <optional>
#include <tuple>
#include <variant>

#include "bindings.hpp"

namespace cluxel::python {

/// One class, or several.
using WordOrWords = std::variant<std::string, std::vector<std::string>>;
std::vector<std::string> wordsOf(const WordOrWords& words);

/// (x, y), an object, its number, or a name.
using PlaceArgument = std::variant<Object, std::size_t, std::string, std::tuple<double, double>>;
Place placeOf(const PlaceArgument& place);

/// "3.1, 4.0"
std::string shortText(const GroundPosition& at);
/// An array of shape (2,): x, y.
py::array_t<double> arrayOf(const GroundPosition& at);
/// An array of shape (N, 2).
py::array_t<double> arrayOf(const std::vector<GroundPosition>& line);

}  // namespace cluxel::python
