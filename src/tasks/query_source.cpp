// SPDX-License-Identifier: Apache-2.0
// Opens maps and RDF files for queries, and reads the headers of shipped questions.
#include "tasks/query_source.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>

#include "base/file_bytes.hpp"
#include "base/nearest_name.hpp"
#include "base/text/short_number.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/work_file.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/finite_number.hpp"

namespace cluxel::tasks {

namespace fs = std::filesystem;

namespace {

/// Reads a header line from its front, and skips the blanks behind each item.
class HeaderReader {
 public:
  explicit HeaderReader(std::string_view line) : rest_(line) {}

  bool mark(std::string_view text) {
    if (!rest_.starts_with(text)) return false;
    take(text.size());
    return true;
  }
  /// Letters, digits and underscores; empty when there are none.
  std::string name() {
    return take(std::min(rest_.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_"),
                         rest_.size()));
  }
  std::string word() { return take(std::min(rest_.find_first_of(kBlanks), rest_.size())); }
  /// The text in brackets.
  std::optional<std::string> unit() {
    const std::size_t close = rest_.find(']');
    if (!rest_.starts_with('[') || close == std::string_view::npos) return std::nullopt;
    const std::string taken = take(close + 1);
    return taken.substr(1, close - 1);
  }
  std::string rest() { return take(rest_.size()); }

 private:
  static constexpr std::string_view kBlanks = " \t\v\f";

  std::string take(std::size_t count) {
    std::string taken(rest_.substr(0, count));
    rest_.remove_prefix(count);
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size()));
    return taken;
  }

  std::string_view rest_;
};

bool readColumn(HeaderReader& header, Question& question) {
  QueryColumn column;
  column.name = header.name();
  const auto unit = header.unit();
  if (column.name.empty() || !unit) return false;
  column.unit = *unit;
  column.help = header.rest();
  question.columns.push_back(std::move(column));
  return true;
}

/// Reads `(from 0)` or `(from 0 to 1)`; without it the range stays open.
bool readRange(HeaderReader& header, QueryParameter& parameter) {
  if (!header.mark("(from ")) return true;
  const auto bound = [&](double& value) {
    std::string word = header.word();
    const bool is_last = word.ends_with(')');
    if (is_last) word.pop_back();
    const auto number = finiteNumber(word);
    if (number) value = *number;
    return number ? std::optional(is_last) : std::nullopt;
  };
  const auto is_closed = bound(parameter.min);
  if (!is_closed || *is_closed) return is_closed.has_value();
  return header.mark("to ") && bound(parameter.max) == true;
}

bool readParameter(HeaderReader& header, Question& question) {
  QueryParameter parameter;
  parameter.name = header.name();
  const auto unit = header.unit();
  if (parameter.name.empty() || !unit || !header.mark("=")) return false;
  parameter.unit = *unit;
  parameter.default_value = header.word();
  if (!readRange(header, parameter)) return false;
  parameter.help = header.rest();
  question.parameters.push_back(std::move(parameter));
  return !question.parameters.back().default_value.empty();
}

bool readTitle(HeaderReader& header, Question& question) {
  question.title = header.rest();
  return !question.title.empty();
}

void readHeaderLine(std::string_view line, const SourceLocation& at, Question& question) {
  HeaderReader header(line);
  const bool is_read = header.mark("title:")       ? readTitle(header, question)
                       : header.mark("column:")    ? readColumn(header, question)
                       : header.mark("parameter:") ? readParameter(header, question)
                                                   : false;
  if (is_read) return;
  constexpr std::size_t max_shown = 200;
  throw InputError(
      at, "this header line cannot be read: '" + std::string(line.substr(0, max_shown)) + "'",
      "write '#! title: …', '#! column: name [unit] help' or '#! parameter: name [unit] = default help'; a range "
      "stands behind the default: '= 0.5 (from 0 to 1) help'");
}

bool isNumber(const std::string& text) {
  return finiteNumber(text).has_value();
}

/// " from 0 to 1"; empty for an open range.
std::string rangeText(const QueryParameter& parameter) {
  std::string text;
  if (std::isfinite(parameter.min)) text += " from " + shortNumber(parameter.min);
  if (std::isfinite(parameter.max)) text += " to " + shortNumber(parameter.max);
  return text;
}

/// Whether a value fits a parameter whose default is a number.
bool isInRange(const std::string& text, const QueryParameter& parameter) {
  const auto value = finiteNumber(text);
  return value && *value >= parameter.min && *value <= parameter.max;
}

Term termOf(const std::string& text) {
  if (text.size() > 1 && text.front() == '<' && text.back() == '>') return Term::iri(text.substr(1, text.size() - 2));
  if (text.starts_with("clx:")) return Term::iri(rdf::vocabulary::clx(text.substr(4)));
  if (isNumber(text))
    return Term::literal(text, rdf::vocabulary::xsd(text.find_first_of("eE") == text.npos ? "decimal" : "double"));
  return Term::literal(text);
}

}  // namespace

QuerySource openQuerySource(const fs::path& file) {
  if (!rdf::rdfFormatOf(file)) {
    QuerySource source{rdf::Environment::open(file, rdf::OpenMode::ReadOnly)};
    mapping::refuseUncommittedBuild(source.environment->read(), file);
    return source;
  }
  QuerySource source{rdf::Environment::temporary()};
  rdf::WriteTransaction transaction = source.environment->write();
  rdf::QuadWriter writer(transaction);
  loadRdf(file, Term::iri(""), writer);
  writer.flush();
  transaction.commit();
  return source;
}

Question readQuestion(const fs::path& file) {
  Question question;
  question.file = file;
  question.text = readFile(file);
  std::istringstream lines(question.text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (!line.starts_with("#!")) continue;
    if (line.ends_with('\r')) line.pop_back();
    const std::size_t begin = line.find_first_not_of(" \t", 2);
    if (begin != std::string::npos)
      readHeaderLine(std::string_view(line).substr(begin), {.file = file.string(), .line = number, .column = 1},
                     question);
  }
  return question;
}

std::vector<Question> shippedQuestions(const DataHome& home) {
  std::vector<Question> questions;
  for (const fs::path& file : filesIn(home.locate("queries"), {".rq"})) questions.push_back(readQuestion(file));
  return questions;
}

std::vector<sparql::Binding> bindingsFor(const Question& question, const std::vector<std::string>& given) {
  std::vector<sparql::Binding> bindings;
  std::vector<std::string> names;
  std::set<std::string> given_names;
  const auto refuse = [](const std::string& text, const std::string& why) {
    throw Error(ErrorKind::InvalidArgument, "parameter " + text + ": " + why, Remedy::NameValue);
  };
  for (const QueryParameter& parameter : question.parameters) {
    bindings.emplace_back(parameter.name, termOf(parameter.default_value));
    names.push_back(parameter.name);
  }
  for (const std::string& text : given) {
    const std::size_t cut = text.find('=');
    const std::string name = text.substr(0, cut);
    const auto place = std::find(names.begin(), names.end(), name);
    if (names.empty()) refuse(text, "the question has no parameters");
    if (cut == std::string::npos) refuse(text, "write NAME=VALUE");
    const std::string hint = suggestion(name, names);
    if (place == names.end()) refuse(text, "the question has no such parameter" + (hint.empty() ? "" : "; " + hint));
    const auto at = static_cast<std::size_t>(place - names.begin());
    if (!given_names.insert(name).second) refuse(text, "it may be given once");
    const QueryParameter& parameter = question.parameters[at];
    const std::string value = text.substr(cut + 1);
    if (isNumber(parameter.default_value) && !isInRange(value, parameter))
      refuse(text, "a number" + rangeText(parameter) + " is expected [" + parameter.unit +
                       "], with a point, for example " + parameter.default_value);
    bindings[at].second = termOf(value);
  }
  return bindings;
}

}  // namespace cluxel::tasks
