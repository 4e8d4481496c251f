// SPDX-License-Identifier: Apache-2.0
// Readers of SPARQL Query Results in JSON, XML, CSV, TSV and as an RDF graph.
#include "sparql/support/results_reader_fixture.hpp"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "cluxel/error.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/syntax/parser.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;

namespace {

using nlohmann::json;

Term jsonTerm(const json& value) {
  const std::string type = value.at("type");
  const std::string text = value.at("value");
  if (type == "uri") return Term::iri(text);
  if (type == "bnode") return Term::blank(text);
  if (type != "literal" && type != "typed-literal") throw std::invalid_argument("unknown type of term '" + type + "'");
  if (value.contains("xml:lang")) return Term::langLiteral(text, value["xml:lang"].get<std::string>());
  if (value.contains("datatype")) return Term::literal(text, value["datatype"].get<std::string>());
  return Term::literal(text);
}

QueryResult jsonResult(const json& document) {
  QueryResult result;
  if (document.contains("boolean")) {
    result.kind = QueryResult::Kind::Boolean;
    result.boolean = document["boolean"];
    return result;
  }
  result.table.variables = document.at("head").at("vars").get<std::vector<std::string>>();
  ResultTableBuilder builder(result.table);
  for (const json& row : document.at("results").at("bindings")) {
    builder.beginRow();
    for (const auto& [variable, value] : row.items()) {
      const std::size_t column = builder.columnOf(variable);
      if (column == std::string::npos) throw std::invalid_argument("the head does not name '" + variable + "'");
      builder.set(column, jsonTerm(value));
    }
  }
  return result;
}

QueryResult readJsonResults(std::string_view text, const std::string& file) {
  try {
    return jsonResult(json::parse(text));
  } catch (const std::exception& fault) {
    throw InputError({.file = file}, std::string("no SPARQL results in JSON: ") + fault.what());
  }
}

/// Splits CSV (RFC 4180) or, without quoting, TSV into records.
std::vector<std::vector<std::string>> recordsOf(std::string_view text, char separator, bool quoting) {
  std::vector<std::vector<std::string>> records;
  for (std::size_t i = 0; i < text.size();) {
    std::vector<std::string>& record = records.emplace_back(1);
    bool quoted = false;
    for (; i < text.size() && (quoted || text[i] != '\n'); ++i) {
      const char c = text[i];
      const bool doubled = quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"';
      if (doubled)
        record.back() += text[++i];
      else if (quoting && c == '"')
        quoted = !quoted;
      else if (c == separator && !quoted)
        record.emplace_back();
      else if (c != '\r' || quoted)
        record.back() += c;
    }
    ++i;
  }
  return records;
}

using CellReader = Term (*)(const std::string& cell, const std::string& file);

QueryResult separatedResult(const std::vector<std::vector<std::string>>& records, const std::string& file,
                            CellReader read) {
  if (records.empty()) throw InputError({.file = file}, "there is no line with the variables' names");
  QueryResult result;
  const bool boolean =
      records.size() == 1 && records[0].size() == 1 && (records[0][0] == "true" || records[0][0] == "false");
  if (boolean) {
    result.kind = QueryResult::Kind::Boolean;
    result.boolean = records[0][0] == "true";
    return result;
  }
  if (records[0].size() > 1 || !records[0][0].empty())
    for (const std::string& name : records[0])
      result.table.variables.push_back(name.starts_with('?') ? name.substr(1) : name);
  ResultTableBuilder builder(result.table);
  const std::size_t width = std::max<std::size_t>(result.table.variables.size(), 1);
  for (std::size_t row = 1; row < records.size(); ++row) {
    if (records[row].size() != width)
      throw InputError({.file = file, .line = row + 1}, "this row has " + std::to_string(records[row].size()) +
                                                            " cells for " + std::to_string(width) + " columns");
    builder.beginRow();
    for (std::size_t column = 0; column < result.table.variables.size(); ++column)
      if (!records[row][column].empty()) builder.set(column, read(records[row][column], file));
  }
  return result;
}

Term csvTerm(const std::string& cell, const std::string&) {
  return cell.starts_with("_:") ? Term::blank(cell.substr(2)) : Term::literal(cell);
}

Term tsvTerm(const std::string& cell, const std::string& file) {
  if (cell.starts_with("_:")) return Term::blank(cell.substr(2));
  SparqlParseOptions options;
  options.file = file;
  const ast::Query query = parseQuery("ASK {} VALUES ?term {\n" + cell + "\n}", options);
  const auto& cells = query.select.values->cells;
  if (cells.size() != 1 || !cells[0]) throw InputError({.file = file}, "the cell '" + cell + "' is not one term");
  return *cells[0];
}

QueryResult readCsvResults(std::string_view text, const std::string& file) {
  return separatedResult(recordsOf(text, ',', true), file, &csvTerm);
}

QueryResult readTsvResults(std::string_view text, const std::string& file) {
  return separatedResult(recordsOf(text, '\t', false), file, &tsvTerm);
}

/// The name of an element without its namespace prefix.
std::string_view localName(pugi::xml_node element) {
  const std::string_view name = element.name();
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

class XmlResults {
 public:
  XmlResults(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  QueryResult read() {
    pugi::xml_document document;
    const unsigned options = pugi::parse_default | pugi::parse_ws_pcdata;  // a literal may be white space only
    const pugi::xml_parse_result parsed =
        document.load_buffer(text_.data(), text_.size(), options, pugi::encoding_utf8);
    if (!parsed) fail(parsed.offset, parsed.description());
    const pugi::xml_node root = document.document_element();
    if (localName(root) != "sparql") fail(0, "there is no <sparql> element");
    for (const pugi::xml_node part : elementsOf(root)) {
      if (localName(part) == "head") head(part);
      if (localName(part) == "results") results(part);
      if (localName(part) == "boolean") boolean(part);
    }
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(std::ptrdiff_t offset, const std::string& message) const {
    throw InputError(locate(file_, text_, static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0))), message);
  }
  static std::vector<pugi::xml_node> elementsOf(pugi::xml_node parent) {
    std::vector<pugi::xml_node> elements;
    for (const pugi::xml_node child : parent.children())
      if (child.type() == pugi::node_element) elements.push_back(child);
    return elements;
  }
  static std::string textOf(pugi::xml_node element) {
    std::string text;
    for (const pugi::xml_node child : element.children()) text += child.value();
    return text;
  }
  std::string name(pugi::xml_node element) const {
    const pugi::xml_attribute name = element.attribute("name");
    if (!name) fail(element.offset_debug(), "<" + std::string(element.name()) + "> lacks the attribute 'name'");
    return name.value();
  }
  void expect(pugi::xml_node element, std::string_view expected) const {
    if (localName(element) != expected)
      fail(element.offset_debug(),
           "<" + std::string(element.name()) + "> where <" + std::string(expected) + "> belongs");
  }
  void head(pugi::xml_node head) {
    if (result_.table.row_count > 0) fail(head.offset_debug(), "<head> must stand before the results");
    for (const pugi::xml_node child : elementsOf(head))
      if (localName(child) == "variable") result_.table.variables.push_back(name(child));
  }
  void results(pugi::xml_node results) {
    for (const pugi::xml_node row : elementsOf(results)) {
      expect(row, "result");
      builder_.beginRow();
      for (const pugi::xml_node cell : elementsOf(row)) {
        expect(cell, "binding");
        const std::size_t column = builder_.columnOf(name(cell));
        if (column == std::string::npos) fail(cell.offset_debug(), "the head does not name '" + name(cell) + "'");
        for (const pugi::xml_node term : elementsOf(cell)) builder_.set(column, termOf(term));
      }
    }
  }
  void boolean(pugi::xml_node element) {
    result_.kind = QueryResult::Kind::Boolean;
    result_.boolean = textOf(element).find("true") != std::string::npos;
  }
  Term termOf(pugi::xml_node element) const {
    const std::string_view kind = localName(element);
    const std::string text = textOf(element);
    if (kind == "uri") return Term::iri(text);
    if (kind == "bnode") return Term::blank(text);
    if (kind != "literal") fail(element.offset_debug(), "unknown type of term <" + std::string(element.name()) + ">");
    if (const pugi::xml_attribute language = element.attribute("xml:lang"))
      return Term::langLiteral(text, language.value());
    if (const pugi::xml_attribute datatype = element.attribute("datatype"))
      return Term::literal(text, datatype.value());
    return Term::literal(text);
  }

  std::string_view text_;
  std::string file_;
  QueryResult result_;
  ResultTableBuilder builder_{result_.table};
};

std::string rs(std::string_view local) {
  return std::string("http://www.w3.org/2001/sw/DataAccess/tests/result-set#").append(local);
}

class GraphResults {
 public:
  GraphResults(const std::vector<Quad>& graph, const std::string& file) : file_(file) {
    for (const Quad& quad : graph) objects_[quad.subject][quad.predicate.text].push_back(quad.object);
  }

  QueryResult read() {
    const Term set = resultSet();
    QueryResult result;
    if (const std::vector<Term>& boolean = all(set, rs("boolean")); !boolean.empty()) {
      result.kind = QueryResult::Kind::Boolean;
      result.boolean = boolean[0].text == "true" || boolean[0].text == "1";
      return result;
    }
    for (const Term& variable : all(set, rs("resultVariable"))) result.table.variables.push_back(variable.text);
    std::sort(result.table.variables.begin(), result.table.variables.end());
    ResultTableBuilder builder(result.table);
    for (const Term& solution : inOrder(all(set, rs("solution")))) addRow(builder, solution);
    return result;
  }

 private:
  Term resultSet() const {
    for (const auto& [subject, properties] : objects_) {
      const auto types = properties.find(vocabulary::rdf("type"));
      if (types == properties.end()) continue;
      if (std::count(types->second.begin(), types->second.end(), Term::iri(rs("ResultSet"))) > 0) return subject;
    }
    throw InputError({.file = file_}, "there is no rs:ResultSet");
  }
  const std::vector<Term>& all(const Term& subject, const std::string& property) const {
    static const std::vector<Term> none;
    const auto properties = objects_.find(subject);
    if (properties == objects_.end()) return none;
    const auto objects = properties->second.find(property);
    return objects == properties->second.end() ? none : objects->second;
  }
  const Term& one(const Term& subject, const std::string& property) const {
    const std::vector<Term>& objects = all(subject, property);
    if (objects.size() != 1)
      throw InputError({.file = file_}, "expected one <" + property + ">, not " + std::to_string(objects.size()));
    return objects[0];
  }
  std::vector<Term> inOrder(std::vector<Term> solutions) const {
    const auto index = [this](const Term& solution) {
      const std::vector<Term>& written = all(solution, rs("index"));
      long value = 0;
      if (!written.empty())
        std::from_chars(written[0].text.data(), written[0].text.data() + written[0].text.size(), value);
      return value;
    };
    std::stable_sort(solutions.begin(), solutions.end(),
                     [&](const Term& a, const Term& b) { return index(a) < index(b); });
    return solutions;
  }
  void addRow(ResultTableBuilder& builder, const Term& solution) const {
    builder.beginRow();
    for (const Term& binding : all(solution, rs("binding"))) {
      const std::size_t column = builder.columnOf(one(binding, rs("variable")).text);
      if (column == std::string::npos)
        throw InputError({.file = file_}, "a binding of a variable that is not announced");
      builder.set(column, one(binding, rs("value")));
    }
  }

  std::string file_;
  std::map<Term, std::map<std::string, std::vector<Term>>> objects_;
};

}  // namespace

QueryResult readResults(std::string_view text, ResultFormat format, const std::string& file) {
  switch (format) {
    case ResultFormat::Json:
      return readJsonResults(text, file);
    case ResultFormat::Xml:
      return XmlResults(text, file).read();
    case ResultFormat::Csv:
      return readCsvResults(text, file);
    case ResultFormat::Tsv:
      return readTsvResults(text, file);
    default:
      throw Error(ErrorKind::InvalidArgument, file + ": answers are read from json, xml, csv and tsv only");
  }
}

QueryResult resultsFromGraph(const std::vector<Quad>& graph, const std::string& file) {
  return GraphResults(graph, file).read();
}

std::string writtenResult(const QueryResult& result, ResultFormat format, const WriterOptions& options) {
  std::string text;
  const auto writer = makeResultWriter(
      format, [&text](std::string_view piece) { text.append(piece); }, options);
  replay(result, *writer);
  return text;
}

}  // namespace cluxel::test
