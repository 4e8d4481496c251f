// SPDX-License-Identifier: Apache-2.0
// Opens what is asked, and reads the headers of shipped questions.
#include "cluxel/tasks/query_source.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <regex>
#include <sstream>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/base/file_bytes.hpp"
#include "cluxel/base/nearest_name.hpp"
#include "cluxel/knowledge/rdf_io.hpp"
#include "cluxel/knowledge/vocabulary.hpp"

namespace cluxel {

namespace fs = std::filesystem;

namespace {

const std::regex kTitle(R"(^title:\s*(\S.*)$)");
const std::regex kColumn(R"(^column:\s*(\w+)\s*\[([^\]]*)\]\s*(.*)$)");
const std::regex kParameter(R"(^parameter:\s*(\w+)\s*\[([^\]]*)\]\s*=\s*(\S+)\s*(.*)$)");

void readHeaderLine(const std::string& line, const SourceLocation& at, Question& question) {
  std::smatch match;
  if (std::regex_match(line, match, kTitle))
    question.title = match[1];
  else if (std::regex_match(line, match, kColumn))
    question.columns.push_back({match[1], match[2], match[3]});
  else if (std::regex_match(line, match, kParameter))
    question.parameters.push_back({match[1], match[2], match[3], match[4]});
  else
    throw InputError(at, "this header line cannot be read: '" + line + "'",
                     "write '#! title: …', '#! column: name [unit] help' or '#! parameter: name [unit] = default help'");
}

bool isNumber(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

Term termOf(const std::string& text) {
  if (text.size() > 1 && text.front() == '<' && text.back() == '>') return Term::iri(text.substr(1, text.size() - 2));
  if (text.starts_with("clx:")) return Term::iri(vocabulary::clx(text.substr(4)));
  if (isNumber(text)) return Term::literal(text, vocabulary::xsd(text.find_first_of("eE") == text.npos ? "decimal" : "double"));
  return Term::literal(text);
}

}  // namespace

QuerySource openQuerySource(const fs::path& file) {
  if (!rdfFormatOf(file)) return {Environment::open(file, OpenMode::ReadOnly)};
  QuerySource source{Environment::temporary()};
  WriteTransaction transaction = source.environment->write();
  QuadWriter writer(transaction);
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
    const std::size_t begin = line.find_first_not_of(" \t", 2);
    if (begin != std::string::npos)
      readHeaderLine(line.substr(begin), {.file = file.string(), .line = number, .column = 1}, question);
  }
  return question;
}

std::vector<Question> shippedQuestions(const DataHome& home) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(home.locate("queries")))
    if (entry.path().extension() == ".rq") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Question> questions;
  for (const fs::path& file : files) questions.push_back(readQuestion(file));
  return questions;
}

std::vector<Binding> bindingsFor(const Question& question, const std::vector<std::string>& given) {
  std::vector<Binding> bindings;
  std::vector<std::string> names;
  const auto refuse = [](const std::string& text, const std::string& why) {
    throw Error(ExitCode::Usage, "--param " + text + ": " + why);
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
    const QueryParameter& parameter = question.parameters[at];
    const std::string value = text.substr(cut + 1);
    if (isNumber(parameter.default_value) && !isNumber(value))
      refuse(text, "a number is wanted [" + parameter.unit + "], with a point, for example " + parameter.default_value);
    bindings[at].second = termOf(value);
  }
  return bindings;
}

}  // namespace cluxel
