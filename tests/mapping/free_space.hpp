// SPDX-License-Identifier: Apache-2.0
// Maps with much free space.
#pragma once

#include <filesystem>
#include <string>

#include "mapping/map_tables.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Leaves free pages: the bytes are written in one commit and erased in the next.
inline void leaveFree(const std::filesystem::path& map, std::size_t bytes) {
  const auto environment = rdf::Environment::open(map, rdf::OpenMode::ReadWrite);
  for (const bool is_there : {true, false}) {
    rdf::WriteTransaction transaction = environment->write();
    if (is_there)
      transaction.putBlock(tables::kMeta, "much", std::string(bytes, 'x'));
    else
      transaction.eraseBlock(tables::kMeta, "much");
    transaction.commit();
  }
}

}  // namespace cluxel::mapping
