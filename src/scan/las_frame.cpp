// SPDX-License-Identifier: Apache-2.0
// Compares what LAS files state.
#include "scan/las_frame.hpp"

#include <utility>

#include "cluxel/error.hpp"

namespace cluxel::scan {

void LasFrame::read(const ScanFile& file) {
  if (file.format != ScanFormat::Las) return;
  const auto stated = lasCrsOf(file.path);
  if (!stated) return;
  if (!std::exchange(unit_noted_, true)) noteUnit(*stated, file.path);
  if (stated->crs.empty())
    return sink_->note(file.path.string() + ": its coordinate system is not kept: " + stated->fault);
  if (!crs_.empty() && crs_ != stated->crs)
    throw InputError({.file = file.path.string()},
                     "has another coordinate system than " + first_.string() + ": " + stated->crs + " and " + crs_,
                     "one map has one frame: transform one of them");
  if (crs_.empty()) crs_ = stated->crs, first_ = file.path;
}

std::string LasFrame::crs() const {
  if (crs_.empty() || params_->frame == InputFrame{}) return crs_;
  sink_->note(first_.string() + ": its coordinate system (" + crs_ +
              ") is not kept, because the coordinates are converted to metres with z up");
  return {};
}

void LasFrame::noteUnit(const LasCrs& stated, const std::filesystem::path& path) const {
  if (stated.is_geographic)
    sink_->note(path.string() + ": warning: its coordinates are degrees (" + stated.crs +
                "); a map needs metres: project the file first");
  else if (const auto unit = unitOf(stated); unit && *unit != params_->frame.unit)
    sink_->note(path.string() + ": warning: the unit of its coordinate system is " + std::string(nameOf(*unit)) +
                ", but its coordinates are read as " + std::string(nameOf(params_->frame.unit)) + "; " +
                params_->remedies.unit);
}

}  // namespace cluxel::scan
