// SPDX-License-Identifier: Apache-2.0
// Random queries from a grammar over the vocabulary of the generated map. The letter of a variable is its type, so that
// patterns usually join and functions usually get suitable arguments.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace cluxel::test {

enum class MadeForm : std::uint8_t { Select, Ask, Construct };

/// Where the second engine deviates from the specification, it gets an equivalent form. These marks enclose Cluxel's
/// form and the second engine's.
inline constexpr char kOurs = '\x01', kTheirs = '\x02', kEnd = '\x03';

struct MadeQuery {
  MadeForm form = MadeForm::Select;
  std::string text;  ///< with the marks, as all texts here
  /// For a query with LIMIT or OFFSET: the same query without them. Any of its rows are right, as many as LIMIT allows.
  std::string unlimited;
  /// The numeric column by which the rows are ordered; empty when the order is not defined.
  std::string ordered_by;
  bool descending = false;
};

/// The letters of variables of numbers and strings.
inline constexpr const char* kNumbers = "nmhij";
inline constexpr const char* kStrings = "stuv";

/// The text for one of the engines.
std::string textFor(char engine, const std::string& marked);

class QueryGenerator {
 public:
  explicit QueryGenerator(std::uint32_t seed) : random_(seed) {}
  MadeQuery next();

 private:
  // query_generator_fixture.cpp: forms and patterns
  std::string group(int depth);
  std::string groupElement(int depth);
  std::string triples();
  std::string triple();
  std::string pathTriple();
  std::string path(int depth);
  std::string alternative(const std::string& subject, const std::string& object);
  std::string optional(int depth);
  std::string unions(int depth);
  std::string minus(int depth);
  std::string graph(int depth);
  std::string bind();
  std::string values();
  std::string subSelect(int depth);
  std::string aggregateSelect(int depth);
  std::string filter();
  std::string aggregate();
  MadeQuery select();
  MadeQuery construct();
  void addModifiers(MadeQuery& query, const std::vector<std::string>& columns);

  // query_expressions_fixture.cpp
  std::string condition(int depth);
  std::string comparison(int depth);
  std::string test(int depth);
  std::string number(int depth);
  std::string string(int depth);
  std::string anything(int depth);
  std::string exists();

  // choices
  std::uint32_t upTo(std::uint32_t limit) { return random_() % limit; }
  bool chance(std::uint32_t percent) { return upTo(100) < percent; }
  std::string one(const std::vector<std::string>& choices) {
    return choices[upTo(static_cast<std::uint32_t>(choices.size()))];
  }
  /// A variable from `letters`, usually one that already occurs in the query.
  std::string variable(const std::string& letters) { return variable(letters, 80); }
  std::string variable(const std::string& letters, std::uint32_t percent_known);
  /// A variable for the object of a triple; numbers and strings are rarely reused.
  std::string value(const std::string& letters) { return variable(letters, 20); }
  std::string anyVariable();
  std::string fresh() { return used("?r" + std::to_string(++fresh_)); }
  std::string used(const std::string& name);

  std::mt19937 random_;
  int fresh_ = 0;
  int patterns_left_ = 0;
  bool in_graph_ = false;  ///< no VALUES, MINUS, sub-selects there: the second engine does not take them graph by graph
  bool no_filters_ = false;  ///< the second engine gives no row at all for a group that it knows to be empty
  std::vector<std::string> used_;
};

}  // namespace cluxel::test
