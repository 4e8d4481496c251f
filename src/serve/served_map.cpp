// SPDX-License-Identifier: Apache-2.0
// Snapshots of a served map.
#include "serve/served_map.hpp"

#include <set>

#include "api/object_query.hpp"
#include "cluxel/error.hpp"
#include "mapping/map_state.hpp"
#include "rdf/file/check/commit_name.hpp"

namespace cluxel::serve {

ServedMap::ServedMap(std::string name, const std::filesystem::path& file)
    : name_(std::move(name)), keeper_(std::filesystem::absolute(file)) {
  keeper_.reader();  // throws when the file is no map
  keeper_.release();
}

bool ServedMap::isUnfinished() const {
  return mapping::hasUnfinishedBuild(rdf::Environment::open(file(), rdf::OpenMode::ReadOnly)->read());
}

std::string ServedMap::state() const {
  try {
    return rdf::commitName(rdf::Environment::open(file(), rdf::OpenMode::ReadOnly)->read());
  } catch (const std::exception&) {  // also of the file system: what was answered stays answered
    return kUnknownState;
  }
}

void ServedMap::withReader(const std::function<void(const mapping::MapReader&)>& use) {
  keepNewest();
  use(mapping::MapReader(file()));
}

void ServedMap::keepNewest() {
  const std::lock_guard lock(keeper_mutex_);
  keeper_.reader();
}

std::shared_ptr<const void> ServedMap::keptOrMade(const rdf::QuadReader& snapshot, const std::string& what,
                                                  const std::function<std::shared_ptr<const void>()>& make) {
  if (auto kept = snapshot.kept(what)) return kept;
  const std::lock_guard lock(makingOf(what));
  if (auto kept = snapshot.kept(what)) return kept;
  std::shared_ptr<const void> made = make();
  snapshot.keep(what, made);
  return made;
}

std::mutex& ServedMap::makingOf(const std::string& what) {
  const std::lock_guard lock(making_mutex_);
  return making_[what];
}

void ServedMap::releaseOldCommit() {
  const std::lock_guard lock(keeper_mutex_);
  keeper_.releaseIfOld();
}

void ServedMap::release() {
  const std::lock_guard lock(keeper_mutex_);
  keeper_.release();
}

std::shared_ptr<const ObjectTable> objectsOf(const rdf::QuadReader& snapshot) {
  constexpr const char* kName = "served objects";
  if (const auto kept = snapshot.kept(kName)) return std::static_pointer_cast<const ObjectTable>(kept);
  auto table = std::make_shared<ObjectTable>();
  table->objects = cluxel::objectsOf(snapshot);
  table->ontology = ontologyViewOf(snapshot);
  table->class_names = rdf::ClassNames(table->ontology.classNames());
  snapshot.keep(kName, table);
  return table;
}

std::vector<MapArgument> mapArgumentsOf(const std::vector<std::string>& texts) {
  std::vector<MapArgument> maps;
  std::set<std::string> names;
  for (const std::string& text : texts) {
    const std::size_t cut = text.find('=');
    const bool is_named = cut != std::string::npos && text.find('/') >= cut;
    const std::filesystem::path file = is_named ? text.substr(cut + 1) : text;
    const std::string name = is_named ? text.substr(0, cut) : file.stem().string();
    if (name.empty() || name == "." || name == "..")
      throw Error(ErrorKind::InvalidArgument, text + ": the map has no name; write NAME=FILE");
    if (!names.insert(name).second)
      throw Error(ErrorKind::InvalidArgument, text + ": two maps are named '" + name + "'; write NAME=FILE");
    maps.push_back({name, file});
  }
  return maps;
}

}  // namespace cluxel::serve
