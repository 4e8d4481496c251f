// SPDX-License-Identifier: Apache-2.0
// The time of day, and points of time as texts.
#pragma once

#include <optional>
#include <string>

namespace cluxel {

/// Seconds since 1970.
double secondsNow();

/// Whether the time lies in the years 1 to 9999, which xsd:dateTime writes with four digits. `time_s`: seconds since
/// 1970.
bool hasCalendarYear(double time_s);

/// The nearest whole microsecond, as dateTimeText() writes it, so that a reader of the text gets the same number. Other
/// times than those of the years 1 to 9999 stay as they are.
double toMicroseconds(double time_s);
std::optional<double> toMicroseconds(std::optional<double> time_s);

/// An xsd:dateTime in UTC with microseconds: "2026-11-22T08:30:00.000000Z". Outside of the years 1 to 9999 the number:
/// "1e+300 s since 1970".
std::string dateTimeText(double time_s);

}  // namespace cluxel
