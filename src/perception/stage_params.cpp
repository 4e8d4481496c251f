// SPDX-License-Identifier: Apache-2.0
// Range errors in words.
#include "cluxel/perception/stage_params.hpp"

#include <sstream>

#include "cluxel/base/diagnostic.hpp"

namespace cluxel {
namespace {

void requireRange(const ParameterInfo& info, double value) {
  if (value >= info.lowest && value <= info.highest) return;
  std::ostringstream text;
  text << "setting " << info.name << " is " << value << ", but must lie between " << info.lowest << " and "
       << info.highest << " " << info.unit << " (" << info.help << ")";
  throw Error(ExitCode::Usage, text.str());
}

}  // namespace

void RangeCheck::real(const ParameterInfo& info, double& value) {
  requireRange(info, value);
}
void RangeCheck::whole(const ParameterInfo& info, int& value) {
  requireRange(info, value);
}

}  // namespace cluxel
