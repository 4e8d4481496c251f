// SPDX-License-Identifier: Apache-2.0
// Tables that hold a row for each object.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "base/content_hash.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Whether what is computed of objects is computed of all objects of the map. Rows of others are then removed.
enum class Covered : std::uint8_t { All, Some };

/// Writes the row of an object, unless it is there.
void putRow(rdf::WriteTransaction& transaction, std::string_view table, const ContentHash& object,
            std::string_view bytes);
/// Adds the rows that another map has of objects of which there is none.
void copyRows(rdf::WriteTransaction& transaction, std::string_view table, const rdf::ReadTransaction& other);
/// Removes the rows of all objects but those of `kept`.
void eraseRowsBut(rdf::WriteTransaction& transaction, std::string_view table, std::vector<ContentHash> kept);
/// Removes what is stored of the presence of objects that the map does not have.
void eraseRowsWithoutObject(rdf::WriteTransaction& transaction);

}  // namespace cluxel::mapping
