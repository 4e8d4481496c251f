// SPDX-License-Identifier: Apache-2.0
// Parses the prologue, IRIs, literals, variables and blank nodes.
#include "base/nearest_name.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/syntax/iri_resolution.hpp"
#include "sparql/syntax/sparql_parser.hpp"

namespace cluxel::sparql {

namespace {

struct KnownPrefix {
  std::string_view prefix, iri;
};
constexpr std::array<KnownPrefix, 10> kKnownPrefixes{{{"clx", rdf::vocabulary::kClx},
                                                      {"rdf", rdf::vocabulary::kRdf},
                                                      {"rdfs", rdf::vocabulary::kRdfs},
                                                      {"owl", rdf::vocabulary::kOwl},
                                                      {"xsd", rdf::vocabulary::kXsd},
                                                      {"geo", rdf::vocabulary::kGeo},
                                                      {"geof", rdf::vocabulary::kGeof},
                                                      {"sosa", rdf::vocabulary::kSosa},
                                                      {"prov", rdf::vocabulary::kProv},
                                                      {"skos", rdf::vocabulary::kSkos}}};

}  // namespace

void SparqlParser::prologue() {
  for (;;) {
    if (take(Keyword::Base))
      baseDeclaration();
    else if (take(Keyword::Prefix))
      prefixDeclaration();
    else
      return;
  }
}

void SparqlParser::baseDeclaration() {
  if (!is(Kind::IriRef)) unexpected("an IRI in <…>");
  base_iri_ = resolved(token_);
  advance();
}

void SparqlParser::prefixDeclaration() {
  if (!is(Kind::PrefixedName) || token_.end != token_.colon + 1) unexpected("a prefix with its colon, as in clx:");
  const std::string_view prefix = source_.text().substr(token_.begin, token_.colon - token_.begin);
  advance();
  if (!is(Kind::IriRef)) unexpected("an IRI in <…>");
  prefixes_.insert_or_assign(std::string(prefix), resolved(token_));
  advance();
}

bool SparqlParser::isNumberStart() const {
  const bool unsigned_number = is(Kind::Integer) || is(Kind::Decimal) || is(Kind::Double);
  return unsigned_number || ((is(Kind::Plus) || is(Kind::Minus)) && token_.number_follows);
}

bool SparqlParser::isTermStart() const {
  return is(Kind::Var) || isIri() || is(Kind::BlankLabel) || is(Kind::Anon) || is(Kind::Nil) || is(Kind::String) ||
         is(Kind::LongString) || is(Keyword::True) || is(Keyword::False) || isNumberStart();
}

std::string SparqlParser::resolved(const Token& iri_ref) const {
  const std::string_view written = source_.text().substr(iri_ref.begin + 1, iri_ref.end - iri_ref.begin - 2);
  if (isAbsoluteIri(written)) return resolveIri(written, {});
  if (base_iri_.empty())
    fail(iri_ref.begin, "the relative IRI <" + std::string(written) + "> has no base",
         "write the whole IRI, or BASE <…> at the beginning");
  return resolveIri(written, base_iri_);
}

std::string SparqlParser::expanded(const Token& name) const {
  const std::string_view prefix = source_.text().substr(name.begin, name.colon - name.begin);
  const auto known = prefixes_.find(prefix);
  if (known == prefixes_.end()) unknownPrefix(name, prefix);
  const std::string_view local = source_.text().substr(name.colon + 1, name.end - name.colon - 1);
  std::string iri;
  iri.reserve(known->second.size() + local.size());
  iri = known->second;
  if (!name.escaped) return iri.append(local);
  for (const char c : local)
    if (c != '\\') iri += c;
  return iri;
}

void SparqlParser::unknownPrefix(const Token& name, std::string_view prefix) const {
  for (const KnownPrefix& known : kKnownPrefixes)
    if (known.prefix == prefix)
      fail(name.begin, "the prefix " + std::string(prefix) + ": is not declared",
           "add PREFIX " + std::string(prefix) + ": <" + std::string(known.iri) + ">");
  std::vector<std::string> declared;
  for (const auto& [known, iri] : prefixes_) declared.push_back(known + ":");
  const std::string near = suggestion(std::string(prefix) + ":", declared);
  fail(name.begin, "the prefix " + std::string(prefix) + ": is not declared",
       near.empty() ? "declare it: PREFIX " + std::string(prefix) + ": <…>" : near);
}

std::string SparqlParser::iriText() {
  std::string text = is(Kind::IriRef) ? resolved(token_) : expanded(token_);
  advance();
  return text;
}

Term SparqlParser::iri(std::string_view expected) {
  if (!isIri()) unexpected(expected);
  return {TermKind::Iri, iriText(), {}, {}};
}

Term SparqlParser::literal() {
  std::string lexical = stringValue();
  if (is(Kind::LangTag)) {
    const std::string_view tag = slice(token_).substr(1);
    Term term = Term::langLiteral(lexical, tag);
    advance();
    return term;
  }
  if (take(Kind::CaretCaret))
    return {TermKind::Literal, std::move(lexical), iri("the datatype's IRI after '^^'").text, {}};
  return {TermKind::Literal, std::move(lexical), rdf::vocabulary::xsd("string"), {}};
}

Term SparqlParser::number() {
  const std::uint32_t begin = token_.begin;
  if (is(Kind::Plus) || is(Kind::Minus)) advance();
  const std::string_view type = is(Kind::Integer) ? "integer" : is(Kind::Decimal) ? "decimal" : "double";
  Term term{
      TermKind::Literal, std::string(source_.text().substr(begin, token_.end - begin)), rdf::vocabulary::xsd(type), {}};
  advance();
  return term;
}

Term SparqlParser::boolean() {
  const bool value = is(Keyword::True);
  advance();
  return Term::boolean(value);
}

std::string SparqlParser::stringValue() {
  if (!is(Kind::String) && !is(Kind::LongString)) unexpected("a string");
  const std::uint32_t quotes = is(Kind::LongString) ? 3 : 1;
  const std::string_view body = slice(token_).substr(quotes, token_.end - token_.begin - 2 * quotes);
  std::string value = token_.escaped ? unescaped(body, token_.begin + quotes) : std::string(body);
  advance();
  return value;
}

std::string SparqlParser::unescaped(std::string_view body, std::uint32_t offset) const {
  constexpr std::string_view written = "tbnrf\"'\\";
  constexpr std::string_view meant = "\t\b\n\r\f\"'\\";
  std::string text;
  text.reserve(body.size());
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (body[i] != '\\') {
      text += body[i];
      continue;
    }
    const std::size_t place = i + 1 < body.size() ? written.find(body[i + 1]) : std::string_view::npos;
    if (place == std::string_view::npos)
      fail(offset + static_cast<std::uint32_t>(i), "this escape means nothing",
           "known are \\t \\b \\n \\r \\f \\\" \\' \\\\ and \\u with 4, \\U with 8 hexadecimal digits");
    text += meant[place];
    ++i;
  }
  return text;
}

ast::VariableIndex SparqlParser::variable(std::string_view expected) {
  if (!is(Kind::Var)) unexpected(expected);
  const ast::VariableIndex index = variableNamed(slice(token_).substr(1));
  advance();
  return index;
}

ast::VariableIndex SparqlParser::variableNamed(std::string_view name) {
  const auto [place, is_new] = variable_of_name_.try_emplace(name, static_cast<ast::VariableIndex>(variables_.size()));
  if (is_new) variables_.push_back({std::string(name), false});
  return place->second;
}

ast::VariableIndex SparqlParser::hiddenVariable(std::string name) {
  variables_.push_back({std::move(name), true});
  return static_cast<ast::VariableIndex>(variables_.size() - 1);
}

void SparqlParser::requireBlankNodesAllowed(std::uint32_t at) const {
  const bool deletes =
      mode_ == NodeMode::DeleteTemplate || mode_ == NodeMode::DeleteData || mode_ == NodeMode::DeleteWhere;
  if (deletes)
    fail(at, "a blank node cannot be deleted by its label", "use a variable and a WHERE pattern that finds it");
}

/// A labelled blank node; in patterns a hidden variable that is limited to one basic graph pattern.
ast::PatternTerm SparqlParser::blankNode(const Token& token) {
  requireBlankNodesAllowed(token.begin);
  const std::string_view label = slice(token).substr(2);
  if (mode_ == NodeMode::InsertData) {
    if (data_labels_.contains(label))
      fail(token.begin, "the blank node label _:" + std::string(label) + " was used by an earlier operation",
           "labels hold for one INSERT DATA; use another label, or one operation");
    operation_labels_.insert(label);
  }
  if (mode_ != NodeMode::Pattern) return {Term::blank(label), token.begin};
  const auto known = blank_nodes_.find(label);
  if (known == blank_nodes_.end()) {
    const ast::VariableIndex index = hiddenVariable("_:" + std::string(label));
    blank_nodes_.emplace(label, BlankNodeUse{block_, index});
    return {index, token.begin};
  }
  if (known->second.block != block_)
    fail(token.begin, "the blank node label _:" + std::string(label) + " is already used in another group of triples",
         "a label holds for one basic graph pattern; use a variable to join them");
  return {known->second.variable, token.begin};
}

ast::PatternTerm SparqlParser::freshBlankNode(std::uint32_t at) {
  requireBlankNodesAllowed(at);
  const std::string name = "[]" + std::to_string(++fresh_count_);  // cannot collide with a written label
  if (mode_ == NodeMode::Pattern) return {hiddenVariable("_:" + name), at};
  return {Term::blank(name), at};
}

ast::PatternTerm SparqlParser::varOrTerm() {
  const std::uint32_t at = here();
  if (!is(Kind::Var)) {
    if (!is(Kind::BlankLabel) && !is(Kind::Anon)) return {graphTerm(), at};
    const Token token = token_;
    advance();
    return token.kind == Kind::Anon ? freshBlankNode(at) : blankNode(token);
  }
  if (mode_ == NodeMode::InsertData || mode_ == NodeMode::DeleteData)
    fail(at, "a variable cannot stand in DATA", "use INSERT { … } WHERE { … } or DELETE { … } WHERE { … }");
  return {variable(), at};
}

ast::PatternTerm SparqlParser::varOrIri(std::string_view expected) {
  const std::uint32_t at = here();
  if (is(Kind::Var)) return varOrTerm();
  return {iri(expected), at};
}

Term SparqlParser::graphTerm() {
  if (isIri()) return iri();
  if (is(Kind::String) || is(Kind::LongString)) return literal();
  if (isNumberStart()) return number();
  if (is(Keyword::True) || is(Keyword::False)) return boolean();
  if (take(Kind::Nil)) return Term::iri(rdf::vocabulary::rdf("nil"));
  unexpected("a variable, an IRI, a literal or a blank node");
}

}  // namespace cluxel::sparql
