// SPDX-License-Identifier: Apache-2.0
// Settings of stages. Each field is described once: for YAML, range checks, --help and the hash that keys stored
// outputs.
#pragma once

#include <string_view>
#include <vector>

#include "base/content_hash.hpp"

namespace cluxel::perception {

/// The declaration of one setting.
struct ParameterInfo {
  std::string_view name;  ///< stage and snake_case name: "thin.voxel". Stored in models: never change it
  std::string_view unit;  ///< "m", "rad", "1"
  double lowest = 0, highest = 0;
  std::string_view help;
};

/// Receives every field of a settings struct in a fixed order and may change it.
class ParameterVisitor {
 public:
  virtual ~ParameterVisitor() = default;
  virtual void real(const ParameterInfo& info, double& value) = 0;
  virtual void whole(const ParameterInfo& info, int& value) = 0;
  virtual void flag(const ParameterInfo& info, bool& value) = 0;
};

/// Throws Error (InvalidArgument) naming the first field outside its range.
class RangeCheck : public ParameterVisitor {
 public:
  void real(const ParameterInfo& info, double& value) override { require(info, value); }
  void whole(const ParameterInfo& info, int& value) override { require(info, value); }
  void flag(const ParameterInfo&, bool&) override {}

 private:
  static void require(const ParameterInfo& info, double value);
};

/// Collects names and values into a hash.
class ParameterHash : public ParameterVisitor {
 public:
  void real(const ParameterInfo& info, double& value) override { hasher_.addText(info.name).add(value); }
  void whole(const ParameterInfo& info, int& value) override { hasher_.addText(info.name).add(value); }
  void flag(const ParameterInfo& info, bool& value) override { hasher_.addText(info.name).add(value); }
  ContentHash finish() { return hasher_.finish(); }

 private:
  ContentHasher hasher_;
};

/// The hash of all fields of a settings struct.
template <typename Params>
ContentHash hashOf(Params params) {
  ParameterHash hash;
  describe(params, hash);
  return hash.finish();
}

/// Throws Error (InvalidArgument) when a field is out of its range. `Params` is any struct with a `describe` function.
template <typename Params>
void checkRanges(Params params) {
  RangeCheck check;
  describe(params, check);
}

}  // namespace cluxel::perception
