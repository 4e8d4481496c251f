// SPDX-License-Identifier: Apache-2.0
// A name for what a commit holds, for those who ask whether a map is still the one that they know.
#pragma once

#include <string>

#include "rdf/file/environment.hpp"

namespace cluxel::rdf {

/// Hexadecimal digits: a hash of the commit's number and of the sums of its quads and terms. Another commit, or another
/// map in place of the file, has another name. Not of write transactions. Cost: microseconds.
std::string commitName(const ReadTransaction& transaction);

}  // namespace cluxel::rdf
