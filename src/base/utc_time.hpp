// SPDX-License-Identifier: Apache-2.0
// Points of time as texts.
#pragma once

#include <string>

namespace cluxel {

/// An xsd:dateTime in UTC with microseconds: "2026-11-22T08:30:00.000000Z". `time_s`: seconds since 1970.
std::string dateTimeText(double time_s);

}  // namespace cluxel
