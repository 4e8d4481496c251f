// SPDX-License-Identifier: Apache-2.0
// Compares what LAS files state, and doubts the units of what they and manifests state.
#include "scan/las_frame.hpp"

#include <optional>
#include <utility>

#include "base/proj_reference_system.hpp"
#include "cluxel/error.hpp"

namespace cluxel::scan {

namespace {

/// What is wrong with the unit of a coordinate system, where a map is to have it. `inputs`: what has it.
std::optional<std::string> faultOfUnit(const LasCrs& stated, const ScanSetParams& params, const std::string& inputs) {
  if (stated.is_geographic)
    return "its coordinates are degrees (" + stated.crs + "); a map needs metres: project " + inputs + " first";
  const auto unit = unitOf(stated);
  if (!unit || *unit == params.frame.unit) return std::nullopt;
  return "the unit of its coordinate system is " + std::string(nameOf(*unit)) + ", but its coordinates are read as " +
         std::string(nameOf(params.frame.unit)) + "; " + params.remedies.unit;
}

std::string notKept(const std::filesystem::path& path, const std::string& crs) {
  return path.string() + ": its coordinate system (" + crs +
         ") is not kept, because the coordinates are converted to metres with z up";
}

}  // namespace

std::string keptCrs(const Manifest& manifest, const std::filesystem::path& path, const ScanSetParams& params,
                    ProgressSink& sink) {
  const std::string& crs = manifest.crs;
  const std::string name = crs.starts_with("+proj") ? crs + " +type=crs" : crs;  // else PROJ takes it for a conversion
  const ReferenceSystem system = referenceSystem(name);
  const LasCrs stated{name, {}, system.kind == ReferenceSystem::Kind::Geographic, {}};
  std::optional<std::string> fault;
  // Scans in a frame of their own may have any unit.
  if (manifest.poses_in_outer || stated.is_geographic) fault = faultOfUnit(stated, params, "the scans");
  if (system.kind == ReferenceSystem::Kind::Unknown)
    fault = "its coordinate system (" + crs +
            ") is not known as one of plane coordinates; state the projected one of the outer frame, or none";
  if (fault) sink.note(path.string() + ": warning: " + *fault);
  const bool is_converted = params.frame.unit != LengthUnit::Metre && unitOf(stated) == params.frame.unit;
  if (is_converted) sink.note(notKept(path, crs));
  return is_converted ? std::string() : crs;
}

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
  sink_->note(notKept(first_, crs_));
  return {};
}

void LasFrame::noteUnit(const LasCrs& stated, const std::filesystem::path& path) const {
  if (const auto fault = faultOfUnit(stated, *params_, "the file")) sink_->note(path.string() + ": warning: " + *fault);
}

}  // namespace cluxel::scan
