// SPDX-License-Identifier: Apache-2.0
// Places as arguments mean what they mean to the library.
#include "places.hpp"

#include <cstdio>

namespace cluxel::python {

std::vector<std::string> wordsOf(const WordOrWords& words) {
  if (const auto* one = std::get_if<std::string>(&words)) return {*one};
  return std::get<std::vector<std::string>>(words);
}

Place placeOf(const PlaceArgument& place) {
  if (const auto* object = std::get_if<Object>(&place)) return object->iri;
  if (const auto* number = std::get_if<std::size_t>(&place)) return "#" + std::to_string(*number);
  if (const auto* name = std::get_if<std::string>(&place)) return *name;
  const auto& [x, y] = std::get<std::tuple<double, double>>(place);
  return GroundPosition{x, y};
}

std::string shortText(const GroundPosition& at) {
  char text[96];
  std::snprintf(text, sizeof text, "%.2f, %.2f", at.x, at.y);
  return text;
}

py::array_t<double> arrayOf(const GroundPosition& at) {
  requireNumpy();
  const double xy[2] = {at.x, at.y};
  return py::array_t<double>(2, xy);
}

py::array_t<double> arrayOf(const std::vector<GroundPosition>& line) {
  requireNumpy();
  py::array_t<double> xy({line.size(), std::size_t{2}});
  double* out = xy.mutable_data();
  for (const GroundPosition& at : line) {
    *out++ = at.x;
    *out++ = at.y;
  }
  return xy;
}

}  // namespace cluxel::python
