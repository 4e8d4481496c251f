// SPDX-License-Identifier: Apache-2.0
// Splits SPARQL text into tokens. Tokens are ranges of the text; nothing is copied or decoded.
#pragma once

#include <cstdint>
#include <string_view>

#include "sparql/syntax/keywords.hpp"

namespace cluxel::sparql {

enum class TokenKind : std::uint8_t {
  End,
  Invalid,
  IriRef,        ///< <…>
  PrefixedName,  ///< prefix:local; a bare "prefix:" has an empty local part
  BlankLabel,    ///< _:label
  Var,           ///< ?name or $name
  Integer,
  Decimal,
  Double,      ///< without sign
  String,      ///< '…' or "…"
  LongString,  ///< '''…''' or """…"""
  LangTag,     ///< @tag
  Word,        ///< a keyword or an unknown word
  Nil,
  Anon,  ///< ( ) and [ ] with only white space inside
  LeftBrace,
  RightBrace,
  LeftParen,
  RightParen,
  LeftBracket,
  RightBracket,
  Dot,
  Semicolon,
  Comma,
  Equal,
  NotEqual,
  Less,
  Greater,
  LessEqual,
  GreaterEqual,
  AndAnd,
  OrOr,
  Bar,
  Bang,
  Slash,
  Star,
  Plus,
  Minus,
  Caret,
  CaretCaret,
  Question
};

struct Token {
  TokenKind kind = TokenKind::End;
  Keyword keyword = Keyword::None;  ///< of a Word
  bool escaped = false;             ///< contains backslash escapes
  bool number_follows = false;      ///< of Plus and Minus: directly followed by a number
  std::uint32_t begin = 0, end = 0;
  std::uint32_t colon = 0;        ///< of a PrefixedName
  const char* problem = nullptr;  ///< of an Invalid token: the error message
};

/// The text must be valid UTF-8 without zero bytes, be shorter than 4 GiB, and outlive the lexer.
class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  /// The first token at or after `offset`; End at the end of the text.
  Token tokenAt(std::uint32_t offset) const;

 private:
  char at(std::size_t offset) const { return offset < text_.size() ? text_[offset] : '\0'; }
  std::size_t skipSpace(std::size_t offset) const;
  std::size_t skipName(std::size_t offset, bool dots) const;
  std::size_t skipLocalName(std::size_t offset, Token& token) const;
  Token punctuation(std::size_t begin) const;
  Token lessOrIri(std::size_t begin) const;
  Token pair(TokenKind empty, TokenKind open, char close, std::size_t begin) const;
  Token number(std::size_t begin) const;
  Token string(std::size_t begin) const;
  Token longString(std::size_t begin) const;
  Token languageTag(std::size_t begin) const;
  Token variable(std::size_t begin) const;
  Token blankLabel(std::size_t begin) const;
  Token wordOrName(std::size_t begin) const;
  Token localName(std::size_t begin, std::size_t colon) const;

  std::string_view text_;
};

}  // namespace cluxel::sparql
