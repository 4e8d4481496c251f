// SPDX-License-Identifier: Apache-2.0
// A token in the cache of a commit tells whether the commit is still the newest.
#include "mapping/newest_map.hpp"

#include "rdf/file/map_replacement.hpp"

namespace cluxel::mapping {

namespace {
constexpr const char* kCommitToken = "newest map";
}

bool NewestMap::isKept() {
  try {
    environment_ = rdf::Environment::open(file_, rdf::OpenMode::ReadOnly);
    const rdf::QuadReader present(environment_->read());
    return reader_ && present.kept(kCommitToken) == state_;
  } catch (...) {  // perhaps the map has another name now, under which it is not written while it is open here
    release();
    environment_.reset();
    throw;
  }
}

bool NewestMap::isNewest() {
  try {
    return isKept();
  } catch (const rdf::LockFileOutdated&) {
    // LMDB finds the newest commit when it opens a map. This has closed it; where other readers of the process have it
    // open, the second attempt fails, too, until they end.
    return isKept();
  }
}

const MapReader& NewestMap::reader() {
  if (isNewest()) return *reader_;
  reader_.reset();
  reader_.emplace(file_);
  state_ = reader_->quads().kept(kCommitToken);
  if (!state_) reader_->quads().keep(kCommitToken, state_ = std::make_shared<int>());
  return *reader_;
}

rdf::QuadReader NewestMap::quads() const {
  return rdf::QuadReader(rdf::Environment::open(file_, rdf::OpenMode::ReadOnly)->read());
}

void NewestMap::release() {
  reader_.reset();
}

void NewestMap::releaseIfOld() {
  if (!isNewest()) release();
}

}  // namespace cluxel::mapping
