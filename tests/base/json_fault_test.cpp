// SPDX-License-Identifier: Apache-2.0
// Faults of JSON are told without the words of the JSON library.
#include "base/json/json_fault.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace cluxel {
namespace {

using nlohmann::json;

template <typename Read>
std::string faultOf(const Read& read) {
  try {
    read();
  } catch (const json::exception& fault) {
    return plainFault(fault);
  }
  return "";
}

TEST(JsonFault, NamesTypesInPlainWords) {
  EXPECT_EQ(faultOf([] { (void)json(5).get<std::string>(); }), "there is a number where a text is wanted");
  EXPECT_EQ(faultOf([] { (void)json("5").get<int>(); }), "there is a text where a number is wanted");
  EXPECT_EQ(faultOf([] { (void)json::object().get<bool>(); }), "there is an object where true or false is wanted");
  EXPECT_EQ(faultOf([] { (void)json(true).get<std::vector<int>>(); }), "there is true or false where a list is wanted");
  EXPECT_EQ(faultOf([] { (void)json().get<double>(); }), "there is null where a number is wanted");
}

TEST(JsonFault, TellsWhatIsThereInsteadOfAnObjectOrAList) {
  EXPECT_EQ(faultOf([] { (void)json::array().at("name"); }), "there is a list where an object {…} is wanted");
  EXPECT_EQ(faultOf([] { (void)json::object().at(0); }), "there is an object where a list […] is wanted");
  EXPECT_EQ(faultOf([] { (void)json("x").at(0); }), "there is a text where an object {…} or a list […] is wanted");
  EXPECT_EQ(faultOf([] { (void)json::array().at(0); }), "a list is too short");
  EXPECT_EQ(faultOf([] { (void)json::object().at("name"); }), "it has no 'name'");
}

}  // namespace
}  // namespace cluxel
