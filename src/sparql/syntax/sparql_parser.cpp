// SPDX-License-Identifier: Apache-2.0
// The parser's token handling and error messages, and its two entry points.
#include "sparql/syntax/sparql_parser.hpp"

#include "base/nearest_name.hpp"
#include "base/utf8.hpp"

namespace cluxel::sparql {

namespace {

constexpr std::size_t kIndexFrom = 16;

std::string_view describe(TokenKind kind) {
  switch (kind) {
    case TokenKind::LeftBrace:
      return "'{'";
    case TokenKind::RightBrace:
      return "'}'";
    case TokenKind::LeftParen:
      return "'('";
    case TokenKind::RightParen:
      return "')'";
    case TokenKind::LeftBracket:
      return "'['";
    case TokenKind::RightBracket:
      return "']'";
    default:
      return "a token";
  }
}

}  // namespace

void VariableSet::add(ast::VariableIndex variable) {
  if (contains(variable)) return;
  items_.push_back(variable);
  if (items_.size() == kIndexFrom) index_.insert(items_.begin(), items_.end());
  if (items_.size() > kIndexFrom) index_.insert(variable);
}

void VariableSet::addAll(const VariableSet& others) {
  for (const ast::VariableIndex variable : others.items_) add(variable);
}

bool VariableSet::contains(ast::VariableIndex variable) const {
  if (items_.size() >= kIndexFrom) return index_.contains(variable);
  for (const ast::VariableIndex item : items_)
    if (item == variable) return true;
  return false;
}

SparqlParser::SparqlParser(std::string_view text, const SparqlParseOptions& options)
    : options_(options),
      source_(text, options.file, std::min<std::size_t>(options.max_bytes, UINT32_MAX - 16)),
      lexer_(source_.text()),
      base_iri_(options.base_iri) {
  for (const auto& [prefix, iri] : options.prefixes) prefixes_.insert_or_assign(prefix, iri);
  token_ = lexer_.tokenAt(source_.text().size() - withoutByteOrderMark(source_.text()).size());
  if (token_.kind == Kind::Invalid) fail(token_.begin, token_.problem);
}

SparqlParser::Nested::Nested(SparqlParser& parser) : parser_(parser) {
  if (parser_.depth_ >= parser_.options_.max_depth)
    parser_.fail(parser_.here(),
                 "the request is nested deeper than " + std::to_string(parser_.options_.max_depth) + " levels",
                 "write it with fewer nested groups, parentheses or operators");
  ++parser_.depth_;
}

void SparqlParser::advance() {
  token_ = lexer_.tokenAt(token_.end);
  if (token_.kind == Kind::Invalid) fail(token_.begin, token_.problem);
  constexpr std::size_t kTokensBetweenCounts = 4096;
  if (++tokens_ % kTokensBetweenCounts == 0 && options_.count) options_.count(kTokensBetweenCounts);
}

bool SparqlParser::take(Kind kind) {
  if (!is(kind)) return false;
  advance();
  return true;
}

bool SparqlParser::take(Keyword keyword) {
  if (!is(keyword)) return false;
  advance();
  return true;
}

void SparqlParser::expect(Kind kind, std::string_view what) {
  if (!take(kind)) unexpected(what.empty() ? describe(kind) : what);
}

void SparqlParser::expect(Keyword keyword) {
  if (!take(keyword)) unexpected(nameOf(keyword), {keyword});
}

void SparqlParser::fail(std::uint32_t offset, std::string message, std::string hint) const {
  source_.fail(offset, std::move(message), std::move(hint));
}

std::string SparqlParser::foundText() const {
  constexpr std::size_t max_bytes = 40;
  if (is(Kind::End)) return "the request ends here";
  std::string_view text = slice(token_);
  if (text.size() <= max_bytes) return "found " + std::string(text);
  return "found " + std::string(utf8Prefix(text, max_bytes)) + "…";
}

/// A suggestion when the token is similar to a keyword or built-in that is allowed here.
std::string SparqlParser::hintFor(std::initializer_list<Keyword> keywords) const {
  if (is(Kind::IriRef)) return "if '<' is a comparison, put a space after it: <…> without spaces is an IRI";
  if (is(Kind::Less)) return "an IRI is written <…>, without spaces or quotes inside";
  if (!is(Kind::Word)) return {};
  std::vector<std::string> known;
  for (const Keyword keyword : keywords) {
    if (keyword != Keyword::FirstBuiltin) {
      known.emplace_back(nameOf(keyword));
      continue;
    }
    for (int i = static_cast<int>(keyword); i <= static_cast<int>(Keyword::LastAggregate); ++i)
      known.emplace_back(nameOf(static_cast<Keyword>(i)));
  }
  const std::optional<std::string> nearest = nearestName(slice(token_), known);
  if (nearest) return "did you mean " + *nearest + "?";
  if (token_.keyword == Keyword::None && known.empty())
    return "a variable is written ?name, a prefixed name prefix:name";
  return {};
}

void SparqlParser::unexpected(std::string_view expected, std::initializer_list<Keyword> keywords) const {
  fail(token_.begin, "expected " + std::string(expected) + ", but " + foundText(), hintFor(keywords));
}

ast::Query parseQuery(std::string_view text, const SparqlParseOptions& options) {
  return SparqlParser(text, options).query();
}

ast::Update parseUpdate(std::string_view text, const SparqlParseOptions& options) {
  return SparqlParser(text, options).update();
}

}  // namespace cluxel::sparql
