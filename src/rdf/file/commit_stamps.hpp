// SPDX-License-Identifier: Apache-2.0
// Commit stamps mark data that must be updated with every commit. An earlier program that does not know the data does
// not renew the stamp, so a stale stamp shows that the data are out of date.
#pragma once

#include <string_view>

#include "rdf/file/environment.hpp"

namespace cluxel::rdf {

/// Stamps the data `name` with the commit that the transaction will make.
void stampCommit(WriteTransaction& transaction, std::string_view name);
/// Whether the data `name` have the stamp of the commit that the transaction sees, or were stamped in it.
bool hasStamp(const ReadTransaction& transaction, std::string_view name);
/// For copies of all blocks of a commit: the stamps of that commit are of the copy, and no other ones are.
void carryStamps(const ReadTransaction& from, WriteTransaction& to);

}  // namespace cluxel::rdf
