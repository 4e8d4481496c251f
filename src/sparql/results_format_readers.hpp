// SPDX-License-Identifier: Apache-2.0
// One reader per format of results.
#pragma once

#include <string>
#include <string_view>

#include "cluxel/sparql/result_table.hpp"

namespace cluxel {

QueryResult readJsonResults(std::string_view text, const std::string& file);
QueryResult readXmlResults(std::string_view text, const std::string& file);
QueryResult readCsvResults(std::string_view text, const std::string& file);
QueryResult readTsvResults(std::string_view text, const std::string& file);

}  // namespace cluxel
