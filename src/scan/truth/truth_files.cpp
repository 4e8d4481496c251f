// SPDX-License-Identifier: Apache-2.0
// Truth files (plain or gzip) and the table of instances.
#include <algorithm>
#include <charconv>
#include <limits>

#include "base/file_bytes.hpp"
#include "base/utf8.hpp"
#include "scan/formats/gzip_text.hpp"
#include "scan/formats/parsed_scan.hpp"
#include "scan/formats/text_scanner.hpp"
#include "scan/truth/truth.hpp"
#include "scan/truth/truth_parsers.hpp"

namespace cluxel::scan {

namespace fs = std::filesystem;

namespace {

/// The longest line that means something: "4 126 2147483647\r\n", and room for blanks and comments.
constexpr std::size_t kBytesPerPoint = 64;

/// A whole number from -1 to `max_code`.
std::int32_t codeOf(TextScanner& scanner, const char* what, std::int32_t max_code) {
  const std::string_view word = scanner.word(what);
  std::int32_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || value < -1 || value > max_code)
    scanner.refuseWord(word, std::string(what) + " must be a whole number from -1 to " + std::to_string(max_code) +
                                 ": '" + std::string(word.substr(0, 40)) + "'");
  return value;
}

std::vector<std::string_view> cellsOf(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

std::size_t columnOf(const std::vector<std::string_view>& header, std::string_view name, const std::string& file) {
  const auto found = std::find(header.begin(), header.end(), name);
  if (found == header.end()) throw InputError({.file = file, .line = 1}, "has no column '" + std::string(name) + "'");
  return static_cast<std::size_t>(found - header.begin());
}

}  // namespace

PointTruth parseTruth(std::string_view bytes, const std::string& file, std::size_t point_count) {
  const std::string text = unpackedText(bytes, file, 4096 + point_count * kBytesPerPoint);
  TextScanner scanner(text, file);
  PointTruth truth;
  truth.class_names = truthClassNames();
  const auto last_class = static_cast<std::int32_t>(truth.class_names.size()) - 1;
  while (scanner.nextLine()) {
    if (truth.primitive.size() == point_count)
      scanner.refuse("more lines than the scan's " + std::to_string(point_count) + " points");
    truth.primitive.push_back(static_cast<std::int8_t>(codeOf(scanner, "primitive", kPrimitiveLabelCount - 1)));
    truth.object_class.push_back(static_cast<std::int8_t>(codeOf(scanner, "object", last_class)));
    truth.instance.push_back(codeOf(scanner, "instance", std::numeric_limits<std::int32_t>::max()));
    scanner.endLine("primitive object instance");
  }
  if (truth.primitive.size() != point_count)
    scanner.refuseEnd("ends after " + std::to_string(truth.primitive.size()) + " lines for " +
                      std::to_string(point_count) + " points");
  return truth;
}

PointTruth truthFromFile(const fs::path& file, std::size_t point_count) {
  return parseTruth(readFile(file), file.string(), point_count);
}

std::optional<fs::path> truthFileOf(const fs::path& folder, const fs::path& scan) {
  for (const fs::path& place : {folder / scan.parent_path().filename(), folder}) {
    const fs::path plain = place / (scan.stem().string() + ".truth"), packed = fs::path(plain).concat(".gz");
    std::error_code unreadable;
    const bool has_plain = fs::is_regular_file(plain, unreadable), has_packed = fs::is_regular_file(packed, unreadable);
    // One of them may be of an earlier labelling.
    if (has_plain && has_packed)
      throw InputError({.file = packed.string()}, "the same truth is there unpacked, as " + plain.filename().string(),
                       "keep one of the two files");
    if (has_plain || has_packed) return has_plain ? plain : packed;
  }
  return std::nullopt;
}

std::vector<std::int32_t> parseAmbiguousInstances(std::string_view text, const std::string& file) {
  // A table that was cut off to nothing would make hidden instances count.
  if (text.empty()) throw InputError({.file = file}, "is empty where a row of column names was expected");
  text = withoutByteOrderMark(text);
  std::vector<std::int32_t> ids;
  std::size_t id_column = 0, ambiguous_column = 0;
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    std::string_view row = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (row.ends_with('\r')) row.remove_suffix(1);
    const std::vector<std::string_view> cells = cellsOf(row);
    if (line == 1) {
      id_column = columnOf(cells, "id", file);
      ambiguous_column = columnOf(cells, "ambiguous", file);
      continue;
    }
    if (row.empty()) continue;
    if (cells.size() <= std::max(id_column, ambiguous_column))
      throw InputError({.file = file, .line = line}, "the row has too few columns");
    const std::string_view id = cells[id_column];
    const std::string_view ambiguous = cells[ambiguous_column];
    std::int32_t number = 0;
    const auto [stop, error] = std::from_chars(id.data(), id.data() + id.size(), number);
    if (error != std::errc() || stop != id.data() + id.size() || number < 0)
      throw InputError({.file = file, .line = line},
                       "the id is not a whole number: '" + std::string(id.substr(0, 40)) + "'");
    if (ambiguous != "0" && ambiguous != "1")
      throw InputError({.file = file, .line = line}, "the column 'ambiguous' must be 0 or 1");
    if (ambiguous == "1") ids.push_back(number);
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

std::vector<std::int32_t> ambiguousInstances(const fs::path& folder) {
  const fs::path table = folder / "instances.csv";
  if (!fs::exists(table)) return {};
  return parseAmbiguousInstances(readFile(table), table.string());
}

}  // namespace cluxel::scan
