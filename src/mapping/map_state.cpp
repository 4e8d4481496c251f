// SPDX-License-Identifier: Apache-2.0
// State and inputs of a map as CBOR blocks.
#include "mapping/map_state.hpp"

#include <nlohmann/json.hpp>

#include "cluxel/error.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/stored_grid.hpp"

namespace cluxel::mapping {

namespace {

using Json = nlohmann::json;
constexpr std::string_view kBuildStateKey = "state", kInputsKey = "inputs";

/// Writes every field of a settings struct by name.
class ParameterWriter : public perception::ParameterVisitor {
 public:
  void real(const perception::ParameterInfo& info, double& value) override { json[std::string(info.name)] = value; }
  void whole(const perception::ParameterInfo& info, int& value) override { json[std::string(info.name)] = value; }
  void flag(const perception::ParameterInfo& info, bool& value) override { json[std::string(info.name)] = value; }
  Json json = Json::object();
};

class ParameterReader : public perception::ParameterVisitor {
 public:
  explicit ParameterReader(const Json& json) : json_(json) {}
  void real(const perception::ParameterInfo& info, double& value) override { value = take(info); }
  void whole(const perception::ParameterInfo& info, int& value) override { value = take(info); }
  void flag(const perception::ParameterInfo& info, bool& value) override { value = take(info); }

 private:
  const Json& take(const perception::ParameterInfo& info) const {
    const auto found = json_.find(std::string(info.name));
    if (found == json_.end())
      throw Error(ErrorKind::StoreUnavailable, "the map has no setting " + std::string(info.name) +
                                                   ": another version of cluxel wrote it; build the map anew");
    return *found;
  }
  const Json& json_;
};

Json textsJson(const std::vector<NamedText>& texts) {
  Json json = Json::array();
  for (const NamedText& text : texts) json.push_back({{"name", text.name}, {"text", text.text}});
  return json;
}

std::vector<NamedText> textsFrom(const Json& json) {
  std::vector<NamedText> texts;
  for (const Json& text : json) texts.push_back({text.at("name"), text.at("text")});
  return texts;
}

void put(rdf::WriteTransaction& transaction, std::string_view key, const Json& json) {
  const auto bytes = Json::to_cbor(json);
  transaction.putBlock(tables::kMeta, key, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

[[noreturn]] void reportDamage(const char* what) {
  throw Error(ErrorKind::StoreUnavailable,
              std::string("the map's description of itself is damaged (") + what + "); build the map anew");
}

}  // namespace

void storeState(rdf::WriteTransaction& transaction, const MapState& state) {
  put(transaction, kBuildStateKey, {{"finished", state.is_finished}, {"inputs", state.inputs_hash}});
}

std::optional<MapState> storedState(const rdf::ReadTransaction& transaction) {
  const auto bytes = transaction.block(tables::kMeta, kBuildStateKey);
  if (!bytes) return std::nullopt;
  try {
    const Json json = Json::from_cbor(*bytes);
    return MapState{json.at("finished"), json.at("inputs")};
  } catch (const Json::exception& fault) {
    reportDamage(fault.what());
  }
}

void storeInputs(rdf::WriteTransaction& transaction, const MapInputs& inputs) {
  ParameterWriter params;
  MapParams copy = inputs.params;
  describe(copy, params);
  const Eigen::Vector3d& origin = inputs.map_origin;
  put(transaction, kInputsKey,
      {{"home", inputs.home},
       {"ontology", textsJson(inputs.ontology)},
       {"rules", textsJson(inputs.rules)},
       {"rule_roots", inputs.rule_roots},
       {"sparql_rules", textsJson(inputs.sparql_rules)},
       {"model", textsJson({inputs.model})},
       {"params", params.json},
       {"map_origin", {origin.x(), origin.y(), origin.z()}},
       {"crs", inputs.crs}});
}

MapInputs storedInputs(const rdf::ReadTransaction& transaction) {
  const auto bytes = transaction.block(tables::kMeta, kInputsKey);
  if (!bytes) reportDamage("no inputs");
  try {
    const Json json = Json::from_cbor(*bytes);
    MapInputs inputs;
    inputs.home = json.value("home", "");
    inputs.ontology = textsFrom(json.at("ontology"));
    inputs.rules = textsFrom(json.at("rules"));
    inputs.rule_roots = json.at("rule_roots");
    inputs.sparql_rules = textsFrom(json.at("sparql_rules"));
    inputs.model = textsFrom(json.at("model")).at(0);
    const Json& params = json.at("params");
    ParameterReader reader(params);
    describe(inputs.params, reader);
    for (int axis = 0; axis < 3; ++axis)
      inputs.map_origin[axis] = json.at("map_origin").at(static_cast<std::size_t>(axis));
    inputs.crs = json.at("crs");
    return inputs;
  } catch (const Error&) {
    throw;
  } catch (const std::exception& fault) {
    reportDamage(fault.what());
  }
}

bool hasUnfinishedBuild(const rdf::ReadTransaction& transaction) {
  const std::optional<MapState> state = storedState(transaction);
  return state && !state->is_finished;
}

bool requireFinished(const std::filesystem::path& file, const rdf::ReadTransaction& transaction) {
  const auto state = storedState(transaction);
  if (state && !state->is_finished)
    throw Error(ErrorKind::InvalidArgument,
                file.string() + ": its build is unfinished; repeat the build command first");
  return state.has_value();
}

MapInputs requireFinishedInputs(const rdf::ReadTransaction& transaction, const std::filesystem::path& file) {
  if (!requireFinished(file, transaction))
    throw Error(ErrorKind::StoreUnavailable, file.string() + ": holds no map that a build has made; build one first");
  MapInputs inputs = storedInputs(transaction);
  // Maps of earlier versions are read as they were written, where tiles may lie and heights be rounded otherwise.
  if (inputs.hash().hex() != storedState(transaction)->inputs_hash || storedGrid(transaction) != inputs.tileGrid())
    refuseOtherVersion(file);
  return inputs;
}

void refuseOtherVersion(const std::filesystem::path& file) {
  throw Error(
      ErrorKind::InvalidArgument,
      file.string() + ": was made by another version of Cluxel, whose stages give other results; build it anew");
}

}  // namespace cluxel::mapping
