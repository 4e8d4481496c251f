// SPDX-License-Identifier: Apache-2.0
// Halves the text until one line more or less decides whether the quad is stated.
#include "rdf/io/quad_place.hpp"

#include <vector>

#include "base/file_bytes.hpp"

namespace cluxel::rdf {

namespace {

constexpr std::size_t kMaxBytes = std::size_t{4} << 20U;

/// A part of a text may end within a sentence: what was stated before counts all the same.
bool states(const RdfSource& source, const std::function<bool(const Quad&)>& is_meant) {
  struct Found {};  // ends the parsing
  try {
    parseRdf(source, [&](const Quad& quad) {
      if (is_meant(quad)) throw Found();
    });
  } catch (const Found&) {
    return true;
  } catch (const InputError&) {
  }
  return false;
}

std::vector<std::size_t> lineEndsOf(const std::string& text) {
  std::vector<std::size_t> ends;
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1)) ends.push_back(at + 1);
  ends.push_back(text.size());
  return ends;
}

}  // namespace

SourceLocation placeInSentences(const RdfSource& source, const std::function<bool(const Quad&)>& is_meant) {
  if (!states(source, is_meant)) return {};
  SourceLocation place{.file = source.name};
  const bool is_file = !source.file.empty();
  if ((is_file ? std::filesystem::file_size(source.file) : source.text.size()) > kMaxBytes) return place;
  const std::string text = is_file ? readFile(source.file) : source.text;
  const std::vector<std::size_t> ends = lineEndsOf(text);
  RdfSource part = source;
  part.file.clear();
  std::size_t without = 0, with = ends.size();  // lines
  while (with - without > 1) {
    const std::size_t middle = without + (with - without) / 2;
    part.text = text.substr(0, ends[middle - 1]);
    (states(part, is_meant) ? with : without) = middle;
  }
  place.line = with;
  return place;
}

}  // namespace cluxel::rdf
