// SPDX-License-Identifier: Apache-2.0
// IRI resolution by RFC 3986, sections 5.2.2 to 5.2.4 and 5.3.
#include "sparql/syntax/iri_resolution.hpp"

#include <optional>

#include "rdf/iri.hpp"
#include "sparql/syntax/character_class.hpp"

namespace cluxel::sparql {

namespace {

struct IriParts {
  std::string_view scheme;                    ///< without ':'
  std::optional<std::string_view> authority;  ///< without "//"
  std::string_view path;
  std::optional<std::string_view> query;     ///< without '?'
  std::optional<std::string_view> fragment;  ///< without '#'
};

std::size_t schemeLength(std::string_view iri) {
  if (iri.empty() || !character::is(iri[0], character::kLetter)) return 0;
  for (std::size_t i = 1; i < iri.size(); ++i) {
    if (iri[i] == ':') return i;
    const bool in_scheme = character::is(iri[i], character::kLetter | character::kDigit) || iri[i] == '+' ||
                           iri[i] == '-' || iri[i] == '.';
    if (!in_scheme) return 0;
  }
  return 0;
}

/// Removes and returns the part of `iri` after `mark`.
std::optional<std::string_view> takeTail(std::string_view& iri, char mark) {
  const std::size_t place = iri.find(mark);
  if (place == std::string_view::npos) return std::nullopt;
  const std::string_view tail = iri.substr(place + 1);
  iri = iri.substr(0, place);
  return tail;
}

IriParts split(std::string_view iri) {
  IriParts parts;
  if (const std::size_t length = schemeLength(iri); length > 0) {
    parts.scheme = iri.substr(0, length);
    iri.remove_prefix(length + 1);
  }
  parts.fragment = takeTail(iri, '#');
  parts.query = takeTail(iri, '?');
  if (iri.starts_with("//")) {
    iri.remove_prefix(2);
    const std::size_t end = std::min(iri.find('/'), iri.size());
    parts.authority = iri.substr(0, end);
    iri.remove_prefix(end);
  }
  parts.path = iri;
  return parts;
}

/// RFC 3986, 5.2.4.
std::string withoutDotSegments(std::string_view in) {
  std::string out;
  const auto dropLastSegment = [&out] { out.resize(out.rfind('/') == std::string::npos ? 0 : out.rfind('/')); };
  while (!in.empty()) {
    if (in.starts_with("../")) {
      in.remove_prefix(3);
    } else if (in.starts_with("./") || in.starts_with("/./")) {
      in.remove_prefix(2);
    } else if (in == "/.") {
      in = "/";
    } else if (in.starts_with("/../")) {
      in.remove_prefix(3);
      dropLastSegment();
    } else if (in == "/..") {
      in = "/";
      dropLastSegment();
    } else if (in == "." || in == "..") {
      break;
    } else {
      const std::size_t end = std::min(in.find('/', 1), in.size());
      out.append(in.substr(0, end));
      in.remove_prefix(end);
    }
  }
  return out;
}

/// RFC 3986, 5.2.3.
std::string mergedPath(const IriParts& base, std::string_view path) {
  if (base.authority && base.path.empty()) return std::string("/").append(path);
  const std::size_t slash = base.path.rfind('/');
  return std::string(base.path.substr(0, slash == std::string_view::npos ? 0 : slash + 1)).append(path);
}

std::string recompose(const IriParts& parts, std::string_view path) {
  std::string iri(parts.scheme);
  iri += ':';
  if (parts.authority) iri.append("//").append(*parts.authority);
  iri.append(path);
  if (parts.query) iri.append("?").append(*parts.query);
  if (parts.fragment) iri.append("#").append(*parts.fragment);
  return iri;
}

}  // namespace

bool isAbsoluteIri(std::string_view iri) {
  return schemeLength(iri) > 0;
}

std::string resolveIri(std::string_view reference, std::string_view base_iri) {
  if (isAbsoluteIri(reference)) {
    if (!rdf::mayHoldDotSegments(reference)) return std::string(reference);
    const IriParts parts = split(reference);
    return recompose(parts, parts.path.starts_with('/') ? withoutDotSegments(parts.path) : std::string(parts.path));
  }
  const IriParts base = split(base_iri);
  IriParts target = split(reference);
  target.scheme = base.scheme;
  if (target.authority) return recompose(target, withoutDotSegments(target.path));
  target.authority = base.authority;
  if (target.path.empty()) {
    if (!target.query) target.query = base.query;
    return recompose(target, base.path);
  }
  if (target.path.starts_with('/')) return recompose(target, withoutDotSegments(target.path));
  return recompose(target, withoutDotSegments(mergedPath(base, target.path)));
}

}  // namespace cluxel::sparql
