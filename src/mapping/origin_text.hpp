// SPDX-License-Identifier: Apache-2.0
// The origin of a map frame as text with all of its digits: who writes it into a manifest means the same frame.
#pragma once

#include <Eigen/Core>
#include <array>
#include <charconv>
#include <string>

namespace cluxel::mapping {

/// The shortest decimal without an exponent that reads as the same number: "451234.5600001", "0.0".
inline std::string exactDecimalText(double value) {
  std::array<char, 512> buffer{};
  std::string text(buffer.data(),
                   std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed).ptr);
  if (text.find('.') == std::string::npos) text += ".0";
  return text == "-0.0" ? "0.0" : text;
}

/// "[451234.5600001, 5423123.78, 210.3]", as a manifest takes it.
inline std::string originText(const Eigen::Vector3d& map_origin) {
  return "[" + exactDecimalText(map_origin.x()) + ", " + exactDecimalText(map_origin.y()) + ", " +
         exactDecimalText(map_origin.z()) + "]";
}

}  // namespace cluxel::mapping
