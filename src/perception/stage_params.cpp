// SPDX-License-Identifier: Apache-2.0
// Error messages for settings out of range.
#include "perception/stage_params.hpp"

#include <sstream>

#include "cluxel/error.hpp"

namespace cluxel::perception {

void RangeCheck::require(const ParameterInfo& info, double value) {
  if (value >= info.lowest && value <= info.highest) return;
  std::ostringstream text;
  text << "setting " << info.name << " is " << value << ", but must lie between " << info.lowest << " and "
       << info.highest << " " << info.unit << " (" << info.help << ")";
  throw Error(ErrorKind::InvalidArgument, text.str());
}

}  // namespace cluxel::perception
