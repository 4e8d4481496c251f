// SPDX-License-Identifier: Apache-2.0
// Reads answers from the result set vocabulary of the DAWG test suites.
#include <algorithm>
#include <charconv>
#include <map>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/knowledge/vocabulary.hpp"
#include "cluxel/sparql/results_reader.hpp"
#include "sparql/result_table_builder.hpp"

namespace cluxel {

namespace {

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

QueryResult resultsFromGraph(const std::vector<Quad>& graph, const std::string& file) {
  return GraphResults(graph, file).read();
}

}  // namespace cluxel
