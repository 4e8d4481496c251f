// SPDX-License-Identifier: Apache-2.0
// The library knows no options: it names a remedy, which is turned into an option here.
#include "app/console/remedy_hint.hpp"

namespace cluxel::app {

namespace {

const char* hintFor(Remedy remedy) {
  switch (remedy) {
    case Remedy::None:
      return "";
    case Remedy::ReplaceMap:
      return "--force replaces it";
    case Remedy::NameHome:
      return "--home or CLUXEL_HOME names the folder that holds ontology, rules, queries, models and labels";
    case Remedy::NamePoses:
      return "--poses FILE names the poses";
    case Remedy::NameTruth:
      return "--truth FOLDER names a folder of truth files";
    case Remedy::ListClouds:
      return "'cluxel info MAP --clouds' lists the clouds of a map";
    case Remedy::NameService:
      return "--service IRI=FILE names the map or RDF file that answers for an IRI";
    case Remedy::NameLoadFile:
      return "--load IRI=FILE names the file that LOAD <IRI> reads";
    case Remedy::NameValue:
      return "--param NAME=VALUE gives a parameter its value; 'cluxel tasks' lists the parameters";
    case Remedy::LocalFrame:
      return "--local writes metres of the map frame instead";
    case Remedy::NameTransform:
      return "--transform FILE names the matrix from the second map to the first";
    case Remedy::ChooseInputs:
      return "--use MAP names that map";
    case Remedy::MoveScans:
      return "'cluxel repose MAP SCANS' gives clouds of a map other poses";
    case Remedy::MergeMaps:
      return "'cluxel merge MAP MAP -o MAP' makes one map of several";
    case Remedy::DropStatements:
      return "--drop-statements drops them";
    case Remedy::NameStart:
      return "--from PLACE names the start: X,Y or an object; `ask` takes from=PLACE";
    case Remedy::NameTime:
      return "--since TIME tells from when on scans count as later; `ask` takes since=TIME";
  }
  return "";
}

}  // namespace

std::string messageOf(const Error& error) {
  const std::string hint = hintFor(error.remedy());
  return hint.empty() ? error.what() : error.what() + ("\n  hint: " + hint);
}

std::string messageOf(const std::filesystem::filesystem_error& error) {
  if (error.path1().empty()) return error.what();
  return error.path1().string() + ": cannot be used: " + error.code().message();
}

}  // namespace cluxel::app
