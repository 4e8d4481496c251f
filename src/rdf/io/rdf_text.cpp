// SPDX-License-Identifier: Apache-2.0
// Cuts texts and files at the ends of lines.
#include "rdf/io/rdf_text.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>

#include "base/content_hash.hpp"
#include "base/shown_line.hpp"
#include "base/utf8.hpp"
#include "cluxel/error.hpp"

namespace cluxel::rdf {

namespace {

constexpr std::size_t kPieceBytes = std::size_t{256} << 10U;

std::uint64_t lineEnds(std::string_view text) {
  return static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n'));
}

/// The length of the lines that are whole in `text`.
std::size_t wholeLines(std::string_view text) {
  const std::size_t end = text.rfind('\n');
  return end == std::string_view::npos ? 0 : end + 1;
}

using OpenFile = std::unique_ptr<std::FILE, decltype(&std::fclose)>;

OpenFile openForReading(const std::filesystem::path& file) {
  OpenFile open(std::fopen(file.c_str(), "rb"), &std::fclose);
  if (!open) throw InputError({.file = file.string()}, std::string("cannot be opened: ") + std::strerror(errno));
  return open;
}

}  // namespace

void RdfText::forEachPiece(const std::function<bool(const RdfPiece&)>& visit) const {
  if (!source_.file.empty()) return forEachPieceOfFile(visit);
  std::string_view rest = source_.text;
  if (source_.format != RdfFormat::RdfXml) rest = withoutByteOrderMark(rest);
  for (RdfPiece piece; !rest.empty(); rest.remove_prefix(piece.text.size())) {
    piece.first_line += lineEnds(piece.text);
    std::size_t size = wholeLines(rest.substr(0, kPieceBytes));
    if (size == 0 || rest.size() <= kPieceBytes) size = std::min(rest.find('\n', kPieceBytes), rest.size() - 1) + 1;
    piece.text = rest.substr(0, size);
    if (!visit(piece)) return;
  }
}

void RdfText::forEachPieceOfFile(const std::function<bool(const RdfPiece&)>& visit) const {
  const OpenFile file = openForReading(source_.file);
  std::string buffer;
  RdfPiece piece;
  for (bool at_begin = true, at_end = false; !at_end;) {
    const std::size_t kept = buffer.size();
    buffer.resize(kept + kPieceBytes);
    const std::size_t read = std::fread(buffer.data() + kept, 1, kPieceBytes, file.get());
    if (std::ferror(file.get()) != 0)
      throw InputError({.file = source_.file.string()}, std::string("cannot be read: ") + std::strerror(errno));
    at_end = read < kPieceBytes;
    buffer.resize(kept + read);
    if (at_begin && buffer.starts_with(kByteOrderMark)) buffer.erase(0, kByteOrderMark.size());
    at_begin = false;
    piece.text = std::string_view(buffer).substr(0, at_end ? buffer.size() : wholeLines(buffer));
    if (piece.text.empty()) continue;
    if (!visit(piece)) return;
    piece.first_line += lineEnds(piece.text);
    buffer.erase(0, piece.text.size());
  }
}

std::string RdfText::hash() const {
  ContentHasher hasher;
  if (source_.file.empty()) {
    hasher.addText(source_.text);
  } else {
    hasher.add(static_cast<std::uint64_t>(std::filesystem::file_size(source_.file)));
    const OpenFile file = openForReading(source_.file);
    std::string buffer(kPieceBytes, '\0');
    while (const std::size_t read = std::fread(buffer.data(), 1, buffer.size(), file.get()))
      hasher.addBytes(buffer.data(), read);
  }
  hasher.addText(source_.base_iri).addText(toNTriples(source_.graph));
  return hasher.finish().hex().substr(0, 12);
}

std::string RdfText::line(std::uint64_t number) const {
  if (source_.file.empty()) return shownLine(source_.text, static_cast<std::size_t>(number));
  std::string found;
  forEachPiece([&](const RdfPiece& piece) {
    const std::uint64_t lines = lineEnds(piece.text);
    if (number >= piece.first_line + lines && !piece.text.empty() && piece.text.back() == '\n') return true;
    found = shownLine(piece.text, static_cast<std::size_t>(number - piece.first_line + 1));
    return false;
  });
  return found;
}

}  // namespace cluxel::rdf
