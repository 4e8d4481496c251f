// SPDX-License-Identifier: Apache-2.0
// Prints expressions and patterns for plans and messages.
#include "rdf/vocabulary.hpp"
#include "sparql/algebra/algebra.hpp"

namespace cluxel::sparql {
namespace {

std::string shortIri(std::string_view iri) {
  using namespace rdf::vocabulary;
  constexpr std::pair<std::string_view, std::string_view> kPrefixes[] = {
      {"clx:", kClx}, {"rdf:", kRdf},   {"rdfs:", kRdfs}, {"owl:", kOwl},   {"xsd:", kXsd},
      {"geo:", kGeo}, {"geof:", kGeof}, {"sosa:", kSosa}, {"prov:", kProv}, {"skos:", kSkos}};
  for (const auto& [prefix, space] : kPrefixes) {
    if (iri.starts_with(space)) return std::string(prefix) + std::string(iri.substr(space.size()));
  }
  return "<" + std::string(iri) + ">";
}

std::string textOf(ValueId id, const QueryTerms& terms) {
  if (id == kUnbound) return "UNDEF";
  const Term term = terms.termOf(id);
  if (term.kind == TermKind::Iri) return shortIri(term.text);
  if (term.kind == TermKind::Literal && !term.datatype.empty() && term.datatype.starts_with(rdf::vocabulary::kXsd)) {
    const Value value = valueOfTerm(term);
    if (value.isNumeric() || value.type == Value::Type::Boolean) return term.text;
  }
  return toNTriples(term);
}

std::string textOf(const PatternPlace& place, const AlgebraQuery& query, const QueryTerms& terms) {
  return place.isSlot() ? "?" + query.slot_names[place.slot] : textOf(place.constant, terms);
}

std::string textOf(const CompiledPath& path, const QueryTerms& terms) {
  using Kind = ast::Path::Kind;
  const auto list = [&](const char* separator) {
    std::string text;
    for (const CompiledPath& part : path.parts) text += (text.empty() ? "(" : separator) + textOf(part, terms);
    return text + ")";
  };
  switch (path.kind) {
    case Kind::Link:
      return textOf(path.iri, terms);
    case Kind::Inverse:
      return "^" + textOf(path.parts[0], terms);
    case Kind::Sequence:
      return list("/");
    case Kind::Alternative:
      return list("|");
    case Kind::ZeroOrMore:
      return textOf(path.parts[0], terms) + "*";
    case Kind::OneOrMore:
      return textOf(path.parts[0], terms) + "+";
    case Kind::ZeroOrOne:
      return textOf(path.parts[0], terms) + "?";
    case Kind::NegatedSet:
      break;
  }
  std::string text = "!(";
  for (const ValueId iri : path.forward) text += textOf(iri, terms) + " ";
  for (const ValueId iri : path.backward) text += "^" + textOf(iri, terms) + " ";
  return text + ")";
}

std::string_view operatorText(Expr::Kind kind) {
  switch (kind) {
    case Expr::Kind::Or:
      return " || ";
    case Expr::Kind::And:
      return " && ";
    case Expr::Kind::Equal:
      return " = ";
    case Expr::Kind::NotEqual:
      return " != ";
    case Expr::Kind::Less:
      return " < ";
    case Expr::Kind::Greater:
      return " > ";
    case Expr::Kind::LessEqual:
      return " <= ";
    case Expr::Kind::GreaterEqual:
      return " >= ";
    case Expr::Kind::Add:
      return " + ";
    case Expr::Kind::Subtract:
      return " - ";
    case Expr::Kind::Multiply:
      return " * ";
    case Expr::Kind::Divide:
      return " / ";
    default:
      return {};
  }
}

}  // namespace

std::string describe(const Expr& expression, const AlgebraQuery& query, const QueryTerms& terms) {
  using Kind = Expr::Kind;
  const auto arguments = [&](std::string_view separator, std::size_t from) {
    std::string text;
    for (std::size_t i = from; i < expression.arguments.size(); ++i) {
      text += (i > from ? std::string(separator) : std::string()) + describe(expression.arguments[i], query, terms);
    }
    return text;
  };
  switch (expression.kind) {
    case Kind::Slot:
      return "?" + query.slot_names[expression.slot];
    case Kind::Constant:
      return expression.constant.id != kUnbound ? textOf(expression.constant.id, terms)
                                                : toNTriples(termOfComputed(expression.constant));
    case Kind::Unbound:
      return "(unbound)";
    case Kind::Bound:
      return "BOUND(?" + query.slot_names[expression.slot] + ")";
    case Kind::Not:
      return "!(" + arguments("", 0) + ")";
    case Kind::Negate:
      return "-(" + arguments("", 0) + ")";
    case Kind::Plus:
      return "+(" + arguments("", 0) + ")";
    case Kind::In:
      return describe(expression.arguments[0], query, terms) + " IN (" + arguments(", ", 1) + ")";
    case Kind::NotIn:
      return describe(expression.arguments[0], query, terms) + " NOT IN (" + arguments(", ", 1) + ")";
    case Kind::Coalesce:
      return "COALESCE(" + arguments(", ", 0) + ")";
    case Kind::If:
      return "IF(" + arguments(", ", 0) + ")";
    case Kind::Call: {
      const std::string_view name = expression.function->name;
      const std::string shown = name.find(':') == std::string_view::npos ? std::string(name) : shortIri(name);
      return shown + "(" + arguments(", ", 0) + ")";
    }
    case Kind::Exists:
      return "EXISTS {…}";
    case Kind::NotExists:
      return "NOT EXISTS {…}";
    default:
      return "(" + arguments(operatorText(expression.kind), 0) + ")";
  }
}

std::string describe(const TripleNode& triple, const AlgebraQuery& query, const QueryTerms& terms) {
  std::string predicate = triple.path ? textOf(*triple.path, terms) : textOf(triple.predicate, query, terms);
  if (!triple.not_predicates.empty()) {
    predicate = "!(";
    for (const ValueId iri : triple.not_predicates) predicate += (predicate == "!(" ? "" : "|") + textOf(iri, terms);
    predicate += ")";
  }
  std::string text = textOf(triple.subject, query, terms) + " " + predicate + " " + textOf(triple.object, query, terms);
  if (triple.graph.kind == GraphPlace::Kind::Slot) text += "  in ?" + query.slot_names[triple.graph.slot];
  if (triple.graph.kind == GraphPlace::Kind::Constant) text += "  in " + textOf(triple.graph.constant, terms);
  return text;
}

}  // namespace cluxel::sparql
