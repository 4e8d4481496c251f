// SPDX-License-Identifier: Apache-2.0
// Tells whether stored data are of the present commit: a program that does not know them leaves their stamp behind when
// it commits a change.
#pragma once

#include <string_view>

#include "rdf/file/environment.hpp"

namespace cluxel::rdf {

/// Says that what goes by this name is of the commit that the transaction will make.
void stampCommit(WriteTransaction& transaction, std::string_view name);
/// Whether it is of the commit that the transaction sees, or has been stamped in it.
bool hasStamp(const ReadTransaction& transaction, std::string_view name);
/// For copies of all blocks of a commit: the stamps of that commit are of the copy, and no other ones are.
void carryStamps(const ReadTransaction& from, WriteTransaction& to);

}  // namespace cluxel::rdf
