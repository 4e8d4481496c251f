// SPDX-License-Identifier: Apache-2.0
// What holds for every reader of scans, whatever it is fed.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "cluxel/error.hpp"
#include "scan/formats/parsed_scan.hpp"

namespace cluxel::fuzz {

using namespace scan;

inline std::string_view textOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

inline void require(bool holds) {
  if (!holds) std::abort();
}

/// Refusals must be InputErrors that say something; anything else that is thrown ends the program.
template <typename Read>
void feed(const Read& read) {
  try {
    read();
  } catch (const InputError& e) {
    require(!e.diagnostics().empty() && !e.diagnostics().front().message.empty());
  }
}

/// A scan that was accepted is whole, finite and not empty.
inline void requireWholeScan(const ParsedScan& scan) {
  const ScanPoints& points = scan.points;
  const std::size_t count = points.size();
  const auto fits = [&](std::size_t size) { return size == 0 || size == count; };
  require(count > 0 && points.y.size() == count && points.z.size() == count);
  require(fits(points.intensity.size()) && fits(points.label.size()) && fits(points.origin.size()));
  for (std::size_t i = 0; i < count; ++i) require(std::isfinite(points.x[i] + points.y[i] + points.z[i]));
  for (const float intensity : points.intensity) require(std::isfinite(intensity));
  require(scan.local_origin.allFinite());
}

}  // namespace cluxel::fuzz
