// SPDX-License-Identifier: Apache-2.0
// Maps as a storage of Redland: librdf's storage "cluxel", over an unmodified librdf.
#pragma once

#include <memory>
#include <optional>

#include "cluxel/knowledge/environment.hpp"

struct librdf_world_s;
struct librdf_storage_s;

namespace cluxel {

/// Makes the storage known to a world as "cluxel". The storage's name is the map's file; options:
/// new='yes' makes a map, which must not exist yet; write='no' opens for reading only; strict='yes' reads statements
/// without a context from the unnamed graph alone instead of the union of all graphs but history.
/// One world per thread. Each change outside a transaction is one commit; add in streams or within transactions.
void registerRedlandStorage(librdf_world_s* world);

/// What an open storage "cluxel" sees: its transaction when it has one, else the latest commit. Nothing for a storage
/// of another kind.
struct RedlandView {
  std::shared_ptr<Environment> environment;
  ReadTransaction transaction;
  bool strict = false;
};
std::optional<RedlandView> viewRedlandStorage(librdf_storage_s* storage);

}  // namespace cluxel
