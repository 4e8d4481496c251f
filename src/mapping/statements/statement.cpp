// SPDX-License-Identifier: Apache-2.0
// A statement is a resource of graph `operator`; anchors are literals that name scans and points.
#include "mapping/statements/statement.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>

#include "cluxel/error.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace {

using rdf::vocabulary::clx;

constexpr std::array<std::string_view, 5> kKindNames{"is", "is not", "remove", "ignore region", "fact"};
constexpr double kStep_m = 1e-4;  ///< of the corners of regions
constexpr std::size_t kMinCorners = 3;

[[noreturn]] void refuseStatement(const std::string& iri, const std::string& what) {
  throw Error(ErrorKind::FaultyInput,
              "operator statement <" + iri + "> " + what + "; leave it out, and state it of the object again");
}

/// "HEX 12 45": the scan, then its points.
std::string anchorText(const scan::ScanId& scan, const std::vector<std::uint32_t>& points) {
  std::string text = scan.hex();
  for (const std::uint32_t point : points) text += " " + std::to_string(point);
  return text;
}

/// "HEX 1.5000 2.0000 0.0000 …": the scan, then x, y, z of each corner.
std::string regionText(const RegionAnchor& region) {
  std::string text = region.scan.hex();
  std::array<char, 64> number{};
  for (const Eigen::Vector3d& corner : region.corners)
    for (const double value : corner) {
      std::snprintf(number.data(), number.size(), " %.4f", std::round(value / kStep_m) * kStep_m + 0.0);
      text += number.data();
    }
  return text;
}

std::vector<std::string_view> wordsOf(std::string_view text) {
  std::vector<std::string_view> words;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    if (end > 0) words.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return words;
}

template <typename Number>
Number numberFrom(std::string_view word, const std::string& iri) {
  Number number{};
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (fault != std::errc() || end != word.data() + word.size())
    refuseStatement(iri, "has an anchor with '" + std::string(word) + "', where a number was expected");
  return number;
}

scan::ScanId scanFrom(const std::vector<std::string_view>& words, const std::string& iri) {
  try {
    return ContentHash::fromHex(words.empty() ? std::string_view() : words.front());
  } catch (const std::invalid_argument&) {
    refuseStatement(iri, "has an anchor that does not begin with the id of a scan");
  }
}

void readAnchor(Statement& statement, const std::string& text, const std::string& iri) {
  const auto words = wordsOf(text);
  std::vector<std::uint32_t>& points = statement.points[scanFrom(words, iri)];
  for (std::size_t i = 1; i < words.size(); ++i) points.push_back(numberFrom<std::uint32_t>(words[i], iri));
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
}

void readRegion(Statement& statement, const std::string& text, const std::string& iri) {
  const auto words = wordsOf(text);
  statement.region.scan = scanFrom(words, iri);
  if (words.size() % 3 != 1 || words.size() / 3 < kMinCorners)
    refuseStatement(iri, "has a region without x, y and z of at least three corners");
  for (std::size_t i = 1; i < words.size(); i += 3) {
    Eigen::Vector3d corner;
    for (int axis = 0; axis < 3; ++axis)
      corner[axis] = numberFrom<double>(words[i + static_cast<std::size_t>(axis)], iri);
    if (!corner.allFinite()) refuseStatement(iri, "has a corner that is not finite");
    statement.region.corners.push_back(corner);
  }
}

/// The values of a statement's properties, as written.
struct Written {
  std::optional<StatementKind> kind;
  std::optional<Term> class_iri, property, value, anchor_class;
};

void takeProperty(Statement& statement, Written& written, const Quad& quad) {
  const std::string& property = quad.predicate.text;
  const std::string& iri = quad.subject.text;
  const auto once = [&](std::optional<Term>& place) {
    if (place) refuseStatement(iri, "has two values of <" + property + ">");
    place = quad.object;
  };
  if (property == clx("statementKind")) {
    const auto name = std::find(kKindNames.begin(), kKindNames.end(), quad.object.text);
    if (name == kKindNames.end() || written.kind) refuseStatement(iri, "has no kind, two, or one that is not known");
    written.kind = static_cast<StatementKind>(name - kKindNames.begin());
  } else if (property == clx("statedClass")) {
    once(written.class_iri);
  } else if (property == clx("statedProperty")) {
    once(written.property);
  } else if (property == clx("statedValue")) {
    once(written.value);
  } else if (property == clx("anchorClass")) {
    once(written.anchor_class);
  } else if (property == clx("anchor")) {
    readAnchor(statement, quad.object.text, iri);
  } else if (property == clx("region")) {
    if (!statement.region.corners.empty()) refuseStatement(iri, "has two regions");
    readRegion(statement, quad.object.text, iri);
  }
}

Statement completedStatement(Statement statement, const Written& written, const std::string& iri) {
  if (!written.kind) refuseStatement(iri, "has no clx:statementKind");
  statement.kind = *written.kind;
  const bool of_class = statement.kind == StatementKind::Is || statement.kind == StatementKind::IsNot;
  if (of_class && (!written.class_iri || written.class_iri->kind != TermKind::Iri))
    refuseStatement(iri, "has no clx:statedClass");
  if (of_class) statement.value = *written.class_iri;
  if (statement.kind == StatementKind::Fact) {
    if (!written.property || !written.value) refuseStatement(iri, "has no clx:statedProperty or no clx:statedValue");
    statement.property = written.property->text;
    statement.value = *written.value;
  }
  const bool has_class = written.anchor_class.has_value();
  if (has_class && written.anchor_class->kind != TermKind::Iri)
    refuseStatement(iri, "has a clx:anchorClass that is no IRI");
  if (has_class) statement.class_iri = written.anchor_class->text;
  if (has_class && (statement.kind != StatementKind::Fact || !statement.points.empty()))
    refuseStatement(iri, "is anchored to a class, which only properties can be, and those to no points");
  const bool is_region = statement.kind == StatementKind::IgnoreRegion;
  if (is_region ? statement.region.corners.empty() : statement.points.empty() && !has_class)
    refuseStatement(iri, "has no anchor");
  if (iri != rdf::iriOfStatement(statement.id()))
    refuseStatement(iri, "was edited: its name is not the hash of its content");
  return statement;
}

}  // namespace

std::string_view nameOf(StatementKind kind) {
  return kKindNames[static_cast<std::size_t>(kind)];
}

ContentHash Statement::id() const {
  ContentHasher hasher;
  hasher.add(kind).addText(property).addText(kind == StatementKind::Remove ? "" : toNTriples(value));
  for (const auto& [scan, numbers] : points) hasher.addText(anchorText(scan, numbers));
  if (kind == StatementKind::IgnoreRegion) hasher.addText(regionText(region));
  if (!class_iri.empty()) hasher.addText(class_iri);
  return hasher.finish();
}

bool lacksScans(const Statement& statement, const std::function<bool(const scan::ScanId&)>& has) {
  if (statement.kind == StatementKind::IgnoreRegion) return !has(statement.region.scan);
  return !statement.points.empty() && std::none_of(statement.points.begin(), statement.points.end(),
                                                   [&](const auto& of_scan) { return has(of_scan.first); });
}

std::string textOf(const Statement& statement) {
  const auto shortened = [](const std::string& iri) {
    if (iri.starts_with(rdf::vocabulary::kClx)) return "clx:" + iri.substr(rdf::vocabulary::kClx.size());
    if (iri.starts_with(rdf::vocabulary::kRdfs)) return "rdfs:" + iri.substr(rdf::vocabulary::kRdfs.size());
    return "<" + iri + ">";
  };
  const std::string name(nameOf(statement.kind));
  switch (statement.kind) {
    case StatementKind::Is:
    case StatementKind::IsNot:
      return name + " " + shortened(statement.value.text);
    case StatementKind::Fact:
      return shortened(statement.property) + " " + toNTriples(statement.value);
    case StatementKind::Remove:
    case StatementKind::IgnoreRegion:
      break;
  }
  return name;
}

std::vector<Quad> quadsOf(const Statement& statement) {
  const Term subject = Term::iri(rdf::iriOfStatement(statement.id()));
  const Term graph = Term::iri(rdf::vocabulary::kGraphOperator);
  std::vector<Quad> quads;
  const auto add = [&](const std::string& property, const Term& object) {
    quads.push_back({subject, Term::iri(property), object, graph});
  };
  add(rdf::vocabulary::rdf("type"), Term::iri(clx("OperatorStatement")));
  add(clx("statementKind"), Term::literal(nameOf(statement.kind)));
  if (statement.kind == StatementKind::Is || statement.kind == StatementKind::IsNot)
    add(clx("statedClass"), statement.value);
  if (statement.kind == StatementKind::Fact) {
    add(clx("statedProperty"), Term::iri(statement.property));
    add(clx("statedValue"), statement.value);
  }
  for (const auto& [scan, points] : statement.points) add(clx("anchor"), Term::literal(anchorText(scan, points)));
  if (!statement.class_iri.empty()) add(clx("anchorClass"), Term::iri(statement.class_iri));
  if (statement.kind == StatementKind::IgnoreRegion) add(clx("region"), Term::literal(regionText(statement.region)));
  return quads;
}

std::vector<Statement> statementsAmong(const std::vector<Quad>& quads) {
  std::map<std::string, std::pair<Statement, Written>> by_iri;
  for (const Quad& quad : quads)
    if (quad.predicate.text == rdf::vocabulary::rdf("type") && quad.object.text == clx("OperatorStatement"))
      by_iri[quad.subject.text];
  for (const Quad& quad : quads)
    if (const auto found = by_iri.find(quad.subject.text); found != by_iri.end())
      takeProperty(found->second.first, found->second.second, quad);
  std::vector<Statement> statements;
  for (auto& [iri, parts] : by_iri) statements.push_back(completedStatement(std::move(parts.first), parts.second, iri));
  std::sort(statements.begin(), statements.end(), [](const auto& a, const auto& b) { return a.id() < b.id(); });
  const auto same = [](const auto& a, const auto& b) { return a.id() == b.id(); };
  statements.erase(std::unique(statements.begin(), statements.end(), same), statements.end());
  return statements;
}

std::vector<Statement> storedStatements(const rdf::QuadReader& reader) {
  const auto graph = reader.idOf(Term::iri(rdf::vocabulary::kGraphOperator));
  const auto kind = reader.idOf(Term::iri(clx("OperatorStatement")));
  if (!graph || !kind) return {};
  std::vector<Quad> quads;
  rdf::QuadCursor typed = reader.scan({.s = {}, .p = {}, .o = *kind, .g = *graph});
  for (rdf::QuadIds subject; typed.next(subject);) {
    rdf::QuadCursor cursor = reader.scan({.s = subject.s, .p = {}, .o = {}, .g = *graph});
    for (rdf::QuadIds quad; cursor.next(quad);)
      quads.push_back({reader.termOf(quad.s), reader.termOf(quad.p), reader.termOf(quad.o), reader.termOf(quad.g)});
  }
  return statementsAmong(quads);
}

}  // namespace cluxel::mapping
