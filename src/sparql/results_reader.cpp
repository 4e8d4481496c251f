// SPDX-License-Identifier: Apache-2.0
// Chooses the reader of a format.
#include "cluxel/sparql/results_reader.hpp"

#include "cluxel/base/diagnostic.hpp"
#include "sparql/results_format_readers.hpp"

namespace cluxel {

QueryResult readResults(std::string_view text, ResultFormat format, const std::string& file) {
  switch (format) {
    case ResultFormat::Json:
      return readJsonResults(text, file);
    case ResultFormat::Xml:
      return readXmlResults(text, file);
    case ResultFormat::Csv:
      return readCsvResults(text, file);
    case ResultFormat::Tsv:
      return readTsvResults(text, file);
    default:
      throw Error(ExitCode::Usage, file + ": answers are read from json, xml, csv and tsv only");
  }
}

}  // namespace cluxel
