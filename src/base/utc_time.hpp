// SPDX-License-Identifier: Apache-2.0
// The time of day, and points of time as texts.
#pragma once

#include <string>

namespace cluxel {

/// Seconds since 1970.
double secondsNow();

/// An xsd:dateTime in UTC with microseconds: "2026-11-22T08:30:00.000000Z". `time_s`: seconds since 1970.
std::string dateTimeText(double time_s);

}  // namespace cluxel
