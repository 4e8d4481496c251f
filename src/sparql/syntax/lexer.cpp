// SPDX-License-Identifier: Apache-2.0
// The SPARQL lexer: longest match over the terminals of the grammar.
#include "sparql/syntax/lexer.hpp"

#include "base/utf8.hpp"
#include "sparql/syntax/character_class.hpp"

namespace cluxel::sparql {

using character::is;
using character::kDigit;
using character::kHigh;
using character::kLetter;
using character::kNotInIri;
using character::kSpace;

namespace {

Token tokenOf(TokenKind kind, std::size_t begin, std::size_t end) {
  Token token;
  token.kind = kind;
  token.begin = static_cast<std::uint32_t>(begin);
  token.end = static_cast<std::uint32_t>(end);
  return token;
}

Token invalid(std::size_t begin, const char* problem) {
  Token token = tokenOf(TokenKind::Invalid, begin, begin + 1);
  token.problem = problem;
  return token;
}

}  // namespace

std::size_t Lexer::skipSpace(std::size_t offset) const {
  for (; offset < text_.size(); ++offset) {
    if (is(text_[offset], kSpace)) continue;
    if (text_[offset] != '#') break;
    offset = text_.find_first_of("\n\r", offset);
    if (offset == std::string_view::npos) return text_.size();
  }
  return offset;
}

Token Lexer::tokenAt(std::uint32_t offset) const {
  const std::size_t begin = skipSpace(offset);
  if (begin >= text_.size()) return tokenOf(TokenKind::End, text_.size(), text_.size());
  const char c = text_[begin];
  if (is(c, kLetter | kHigh)) return wordOrName(begin);
  if (is(c, kDigit) || (c == '.' && is(at(begin + 1), kDigit))) return number(begin);
  switch (c) {
    case '?':
    case '$':
      return variable(begin);
    case '<':
      return lessOrIri(begin);
    case '"':
    case '\'':
      return string(begin);
    case '@':
      return languageTag(begin);
    case '_':
      return blankLabel(begin);
    case ':':
      return localName(begin, begin);
    case '(':
      return pair(TokenKind::Nil, TokenKind::LeftParen, ')', begin);
    case '[':
      return pair(TokenKind::Anon, TokenKind::LeftBracket, ']', begin);
    default:
      return punctuation(begin);
  }
}

Token Lexer::punctuation(std::size_t begin) const {
  const char next = at(begin + 1);
  const auto one = [begin](TokenKind kind) { return tokenOf(kind, begin, begin + 1); };
  const auto two = [begin](TokenKind kind) { return tokenOf(kind, begin, begin + 2); };
  switch (text_[begin]) {
    case '{':
      return one(TokenKind::LeftBrace);
    case '}':
      return one(TokenKind::RightBrace);
    case ')':
      return one(TokenKind::RightParen);
    case ']':
      return one(TokenKind::RightBracket);
    case '.':
      return one(TokenKind::Dot);
    case ';':
      return one(TokenKind::Semicolon);
    case ',':
      return one(TokenKind::Comma);
    case '*':
      return one(TokenKind::Star);
    case '/':
      return one(TokenKind::Slash);
    case '=':
      return one(TokenKind::Equal);
    case '!':
      return next == '=' ? two(TokenKind::NotEqual) : one(TokenKind::Bang);
    case '>':
      return next == '=' ? two(TokenKind::GreaterEqual) : one(TokenKind::Greater);
    case '|':
      return next == '|' ? two(TokenKind::OrOr) : one(TokenKind::Bar);
    case '^':
      return next == '^' ? two(TokenKind::CaretCaret) : one(TokenKind::Caret);
    case '&':
      return next == '&' ? two(TokenKind::AndAnd) : invalid(begin, "a single '&' means nothing; and is '&&'");
    case '+':
    case '-': {
      Token token = one(text_[begin] == '+' ? TokenKind::Plus : TokenKind::Minus);
      token.number_follows = is(next, kDigit) || (next == '.' && is(at(begin + 2), kDigit));
      return token;
    }
    case '\\':
      return invalid(begin, "a backslash may stand only within strings and local names");
    default:
      return invalid(begin, "this character has no meaning here");
  }
}

Token Lexer::lessOrIri(std::size_t begin) const {
  std::size_t end = begin + 1;
  while (end < text_.size() && !is(text_[end], kNotInIri)) ++end;
  if (at(end) == '>') return tokenOf(TokenKind::IriRef, begin, end + 1);
  if (at(begin + 1) == '=') return tokenOf(TokenKind::LessEqual, begin, begin + 2);
  return tokenOf(TokenKind::Less, begin, begin + 1);
}

Token Lexer::pair(TokenKind empty, TokenKind open, char close, std::size_t begin) const {
  const std::size_t inside = skipSpace(begin + 1);
  if (at(inside) == close) return tokenOf(empty, begin, inside + 1);
  return tokenOf(open, begin, begin + 1);
}

Token Lexer::number(std::size_t begin) const {
  std::size_t end = begin;
  const auto digits = [&] {
    while (is(at(end), kDigit)) ++end;
  };
  TokenKind kind = TokenKind::Integer;
  digits();
  std::size_t after_mantissa = end;
  if (at(end) == '.') {
    const std::size_t point = end++;
    digits();
    if (end > point + 1) kind = TokenKind::Decimal;
    after_mantissa = kind == TokenKind::Decimal ? end : point;
  }
  if (at(end) == 'e' || at(end) == 'E') {
    ++end;
    if (at(end) == '+' || at(end) == '-') ++end;
    const std::size_t exponent = end;
    digits();
    if (end > exponent) return tokenOf(TokenKind::Double, begin, end);
  }
  return tokenOf(kind, begin, after_mantissa);
}

Token Lexer::string(std::size_t begin) const {
  const char quote = text_[begin];
  if (at(begin + 1) == quote && at(begin + 2) == quote) return longString(begin);
  bool escaped = false;
  for (std::size_t i = begin + 1; i < text_.size(); ++i) {
    const char c = text_[i];
    if (c == quote) {
      Token token = tokenOf(TokenKind::String, begin, i + 1);
      token.escaped = escaped;
      return token;
    }
    if (c == '\n' || c == '\r') break;
    if (c != '\\') continue;
    escaped = true;
    ++i;
  }
  return invalid(begin, "the string is not closed on its line; one over several lines stands in ''' or \"\"\"");
}

Token Lexer::longString(std::size_t begin) const {
  const char quote = text_[begin];
  bool escaped = false;
  for (std::size_t i = begin + 3; i < text_.size(); ++i) {
    const char c = text_[i];
    if (c == quote && at(i + 1) == quote && at(i + 2) == quote) {
      Token token = tokenOf(TokenKind::LongString, begin, i + 3);
      token.escaped = escaped;
      return token;
    }
    if (c != '\\') continue;
    escaped = true;
    ++i;
  }
  return invalid(begin, "the string is never closed");
}

Token Lexer::languageTag(std::size_t begin) const {
  std::size_t end = begin + 1;
  while (is(at(end), kLetter)) ++end;
  if (end == begin + 1) return invalid(begin, "a language tag must follow '@', as in \"tree\"@en");
  while (at(end) == '-' && is(at(end + 1), kLetter | kDigit)) {
    ++end;
    while (is(at(end), kLetter | kDigit)) ++end;
  }
  return tokenOf(TokenKind::LangTag, begin, end);
}

Token Lexer::variable(std::size_t begin) const {
  std::size_t end = begin + 1;
  while (end < text_.size()) {
    const char c = text_[end];
    if (is(c, kLetter | kDigit) || c == '_') {
      ++end;
      continue;
    }
    if (!is(c, kHigh)) break;
    const CodePoint code_point = decodeUtf8(text_, end);
    const bool start = character::isNameStart(code_point.value);
    const bool extra = end > begin + 1 && character::isNameExtra(code_point.value);
    if (!start && !extra) break;
    end += code_point.bytes;
  }
  if (end > begin + 1) return tokenOf(TokenKind::Var, begin, end);
  if (text_[begin] == '?') return tokenOf(TokenKind::Question, begin, end);
  return invalid(begin, "a variable's name must follow '$'");
}

/// Returns the offset after a run of PN_CHARS and, if `dots`, inner dots; a name cannot end with a dot.
std::size_t Lexer::skipName(std::size_t offset, bool dots) const {
  std::size_t end = offset;
  while (offset < text_.size()) {
    const char c = text_[offset];
    if (is(c, kLetter | kDigit) || c == '_' || c == '-') {
      end = ++offset;
    } else if (c == '.' && dots) {
      ++offset;
    } else if (is(c, kHigh)) {
      const CodePoint code_point = decodeUtf8(text_, offset);
      if (!character::isNameStart(code_point.value) && !character::isNameExtra(code_point.value)) break;
      end = offset += code_point.bytes;
    } else {
      break;
    }
  }
  return end;
}

Token Lexer::blankLabel(std::size_t begin) const {
  if (at(begin + 1) != ':') return invalid(begin, "a name cannot begin with '_'; a blank node is written _:label");
  const char first = at(begin + 2);
  const bool high_start = is(first, kHigh) && character::isNameStart(decodeUtf8(text_, begin + 2).value);
  if (!is(first, kLetter | kDigit) && first != '_' && !high_start)
    return invalid(begin, "a label must follow '_:', as in _:b1");
  return tokenOf(TokenKind::BlankLabel, begin, skipName(begin + 2, true));
}

Token Lexer::wordOrName(std::size_t begin) const {
  if (is(text_[begin], kHigh) && !character::isNameStart(decodeUtf8(text_, begin).value))
    return invalid(begin, "this character has no meaning here");
  std::size_t end = begin;
  while (is(at(end), kLetter | kDigit) || at(end) == '_') ++end;
  if (at(end) == ':') return localName(begin, end);
  if (at(end) == '-' || at(end) == '.' || is(at(end), kHigh)) {
    const std::size_t prefix_end = skipName(begin, true);
    if (at(prefix_end) == ':') return localName(begin, prefix_end);
  }
  if (end == begin) return invalid(begin, "this character has no meaning here");
  Token token = tokenOf(TokenKind::Word, begin, end);
  token.keyword = keywordOf(text_.substr(begin, end - begin));
  return token;
}

Token Lexer::localName(std::size_t begin, std::size_t colon) const {
  Token token = tokenOf(TokenKind::PrefixedName, begin, colon + 1);
  token.colon = static_cast<std::uint32_t>(colon);
  const char first = at(colon + 1);
  const bool high_start = is(first, kHigh) && character::isNameStart(decodeUtf8(text_, colon + 1).value);
  const bool plain_start = is(first, kLetter | kDigit) || first == '_' || first == ':';
  if (!plain_start && !high_start && first != '%' && first != '\\') return token;
  token.end = static_cast<std::uint32_t>(skipLocalName(colon + 1, token));
  return token;
}

/// As skipName(), including colons, percent escapes and backslash escapes of a local name; marks `token` as invalid at
/// a malformed escape.
std::size_t Lexer::skipLocalName(std::size_t offset, Token& token) const {
  constexpr std::string_view escapable = "_~.-!$&'()*+,;=/?#@%";
  std::size_t end = offset;
  while (offset < text_.size()) {
    const char c = text_[offset];
    if (c == ':') {
      end = ++offset;
    } else if (c == '.') {
      ++offset;
    } else if (c == '%') {
      if (!character::isHexDigit(at(offset + 1)) || !character::isHexDigit(at(offset + 2))) {
        token = invalid(offset, "two hexadecimal digits must follow '%' in a local name");
        return token.end;
      }
      end = offset += 3;
    } else if (c == '\\') {
      if (offset + 1 >= text_.size() || escapable.find(text_[offset + 1]) == std::string_view::npos) {
        token = invalid(offset, "in a local name a backslash may stand only before one of _~.-!$&'()*+,;=/?#@%");
        return token.end;
      }
      token.escaped = true;
      end = offset += 2;
    } else {
      const std::size_t name_end = skipName(offset, false);
      if (name_end == offset) break;
      end = offset = name_end;
    }
  }
  return end;
}

}  // namespace cluxel::sparql
