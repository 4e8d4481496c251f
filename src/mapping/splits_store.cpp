// SPDX-License-Identifier: Apache-2.0
// Objects by rules as one packed CBOR block; lists of cluxels as planes of their differences.
#include "mapping/object_store.hpp"

#include <nlohmann/json.hpp>

#include "base/packing/zstd_packing.hpp"
#include "cluxel/error.hpp"
#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

using Json = nlohmann::json;
constexpr std::string_view kByRulesKey = "objects by rules", kSplitsKey = "splits";
/// The numbers of a billion cluxels.
constexpr std::uint64_t kMaxObjectBytes = std::uint64_t{1} << 32U;

Json numbersJson(const std::vector<std::uint32_t>& numbers) {
  std::string planes;
  appendPlanes(planes, differencesOf(numbers).data(), numbers.size(), sizeof(std::uint32_t));
  return Json::binary({planes.begin(), planes.end()});
}

std::vector<std::uint32_t> numbersFrom(const Json& json) {
  const auto& bytes = json.get_binary();
  std::vector<std::uint32_t> numbers(bytes.size() / sizeof(std::uint32_t));
  readPlanes(reinterpret_cast<const char*>(bytes.data()), numbers.data(), numbers.size(), sizeof(std::uint32_t));
  sumUp(numbers);
  return numbers;
}

Json partJson(const rules::ObjectPart& part) {
  return {
      {"class", part.part_class}, {"primitives", numbersJson(part.primitives)}, {"cluxels", numbersJson(part.cluxels)}};
}

rules::ObjectPart partFrom(const Json& json) {
  return {json.at("class"), numbersFrom(json.at("primitives")), numbersFrom(json.at("cluxels"))};
}

Json objectJson(const rules::SemanticObject& object) {
  Json json{{"id", object.id.hex()},  {"class", object.class_iri},          {"confidence", object.confidence},
            {"rule", object.rule_id}, {"class_wide", object.is_class_wide}, {"parts", Json::array()}};
  for (const rules::ObjectPart& part : object.parts) json["parts"].push_back(partJson(part));
  return json;
}

rules::SemanticObject objectFrom(const Json& json) {
  rules::SemanticObject object;
  object.id = ContentHash::fromHex(json.at("id").get<std::string>());
  object.class_iri = json.at("class");
  object.confidence = json.at("confidence");
  object.rule_id = json.at("rule");
  object.is_class_wide = json.at("class_wide");
  for (const Json& part : json.at("parts")) object.parts.push_back(partFrom(part));
  return object;
}

}  // namespace

void storeObjectsByRules(rdf::WriteTransaction& transaction, const std::vector<rules::SemanticObject>& objects) {
  Json json = Json::array();
  for (const rules::SemanticObject& object : objects) json.push_back(objectJson(object));
  const auto bytes = Json::to_cbor(json);
  transaction.putBlock(tables::kMeta, kByRulesKey,
                       packedBytes({reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
}
std::vector<rules::SemanticObject> storedObjectsByRules(const rdf::ReadTransaction& transaction) {
  std::vector<rules::SemanticObject> objects;
  const auto bytes = transaction.block(tables::kMeta, kByRulesKey);
  if (!bytes) return objects;
  try {
    const auto unpacked = unpackedBytes(*bytes, kMaxObjectBytes);
    if (!unpacked) throw std::invalid_argument("not in the form in which this version of cluxel writes them");
    for (const Json& object : Json::from_cbor(unpacked->view())) objects.push_back(objectFrom(object));
  } catch (const std::exception& fault) {
    throw Error(ErrorKind::StoreUnavailable,
                std::string("the map's objects cannot be read (") + fault.what() + "); build the map anew");
  }
  return objects;
}
void eraseObjectsByRules(rdf::WriteTransaction& transaction) {
  transaction.eraseBlock(tables::kMeta, kByRulesKey);
}

void storeSplits(rdf::WriteTransaction& transaction, const rules::KnownSplits& splits) {
  if (splits.count() == 0)
    transaction.eraseBlock(tables::kMeta, kSplitsKey);
  else
    transaction.putBlock(tables::kMeta, kSplitsKey, splits.stored());
}

rules::KnownSplits storedSplits(const rdf::ReadTransaction& transaction) {
  const auto bytes = transaction.block(tables::kMeta, kSplitsKey);
  return bytes ? rules::KnownSplits(*bytes) : rules::KnownSplits();
}

}  // namespace cluxel::mapping
