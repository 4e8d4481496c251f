// SPDX-License-Identifier: Apache-2.0
// Writes settings to JSON and reads them back.
#include "perception/crf/model_settings.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "cluxel/error.hpp"

namespace cluxel::perception {

namespace {

using Json = nlohmann::ordered_json;

class SettingsWriter : public ParameterVisitor {
 public:
  void real(const ParameterInfo& info, double& value) override { json[std::string(info.name)] = value; }
  void whole(const ParameterInfo& info, int& value) override { json[std::string(info.name)] = value; }
  void flag(const ParameterInfo& info, bool& value) override { json[std::string(info.name)] = value; }

  Json json = Json::object();
};

class SettingsReader : public ParameterVisitor {
 public:
  explicit SettingsReader(const Json& json) : json_(json) {}

  void real(const ParameterInfo& info, double& value) override {
    value = take(info, &Json::is_number).get<double>();
    if (!std::isfinite(value)) fail(info, "is not finite");
  }
  void whole(const ParameterInfo& info, int& value) override {
    const auto number = take(info, &Json::is_number_integer).get<std::int64_t>();
    if (number < -1000000000 || number > 1000000000) fail(info, "is out of range");
    value = static_cast<int>(number);
  }
  void flag(const ParameterInfo& info, bool& value) override { value = take(info, &Json::is_boolean).get<bool>(); }

  std::size_t taken() const { return taken_; }

 private:
  const Json& take(const ParameterInfo& info, bool (Json::*fits)() const noexcept) {
    const auto found = json_.find(std::string(info.name));
    if (found == json_.end()) fail(info, "is missing");
    if (!((*found).*fits)()) fail(info, "is of another kind");
    ++taken_;
    return *found;
  }
  [[noreturn]] static void fail(const ParameterInfo& info, const char* what) {
    throw std::invalid_argument("setting " + std::string(info.name) + " " + what);
  }

  const Json& json_;
  std::size_t taken_ = 0;
};

}  // namespace

Json perceptionSettings(PerceptionParams params) {
  SettingsWriter writer;
  describe(params, writer);
  return writer.json;
}

PerceptionParams perceptionSettingsFrom(const Json& json) {
  if (!json.is_object()) throw std::invalid_argument("the perception settings are not an object");
  PerceptionParams params;
  SettingsReader reader(json);
  describe(params, reader);
  if (reader.taken() != json.size()) throw std::invalid_argument("the perception settings have unknown names");
  try {
    checkRanges(params);
  } catch (const Error& fault) {
    throw std::invalid_argument(fault.what());
  }
  return params;
}

}  // namespace cluxel::perception
