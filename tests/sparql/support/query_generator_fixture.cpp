// SPDX-License-Identifier: Apache-2.0
// Query forms and graph patterns of the generator. Letters: a b c objects, k l classes, n m h i j numbers, s t u v
// strings, e blank nodes, f booleans, p q predicates, g graphs, x y z any terms, r results of BIND and aggregates.
#include "sparql/support/query_generator_fixture.hpp"

#include <algorithm>
#include <utility>

#include "sparql/support/generated_map_fixture.hpp"

namespace cluxel::test {

namespace {

const std::string kPrologue =
    "PREFIX clx: <https://w3id.org/cluxel/ontology#> PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#> "
    "PREFIX xsd: <http://www.w3.org/2001/XMLSchema#> PREFIX o: <https://w3id.org/cluxel/map/object/>\n";

std::string joined(const std::vector<std::string>& parts, const std::string& between) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : between) + part;
  return text;
}

}  // namespace

std::string textFor(char engine, const std::string& marked) {
  std::string text;
  char part = 0;
  for (const char c : marked) {
    if (c == kOurs || c == kTheirs)
      part = c;
    else if (c == kEnd)
      part = 0;
    else if (part == 0 || part == engine)
      text += c;
  }
  return text;
}

std::string QueryGenerator::used(const std::string& name) {
  if (std::find(used_.begin(), used_.end(), name) == used_.end()) used_.push_back(name);
  return name;
}

std::string QueryGenerator::variable(const std::string& letters, std::uint32_t percent_known) {
  std::vector<std::string> candidates;
  for (const std::string& name : used_)
    if (name.size() == 2 && letters.find(name[1]) != std::string::npos) candidates.push_back(name);
  if (!candidates.empty() && chance(percent_known)) return one(candidates);
  return used(std::string("?") + letters[upTo(static_cast<std::uint32_t>(letters.size()))]);
}

std::string QueryGenerator::anyVariable() {
  return used_.empty() || chance(5) ? variable("ax") : one(used_);
}

std::string QueryGenerator::triple() {
  const std::string subject = chance(88) ? variable("ab") : "o:" + std::to_string(upTo(8));
  switch (upTo(13)) {
    case 0:
    case 1:
      return subject + " a " +
             (chance(50) ? variable("kl", 50) : one({"clx:Tree", "clx:Static", "clx:Car", "clx:Lamp"}));
    case 2:
      return subject + " clx:height " + value(kNumbers);
    case 3:
      return subject + " clx:width " + (chance(85) ? value(kNumbers) : "2.5");
    case 4:
      return subject + " clx:pointCount " + (chance(85) ? value(kNumbers) : "3");
    case 5:
      return subject + " clx:label " +
             (chance(80) ? value(kStrings) : one({"\"oak\"", "\"Eiche\"@de", "\"Tree\"@en-gb"}));
    case 6:
      return subject + " clx:note " + value(kStrings);
    case 7:
      return subject + " clx:near " + value(subject == "?a" ? "bc" : "ac");
    case 8:
      return subject + " clx:hasPart " + (chance(70) ? value("c") : "[ clx:height " + value(kNumbers) + " ]");
    case 9:
      return subject + " clx:centroid " + used("?e") + " . ?e clx:x " + value(kNumbers);
    case 10:
      return subject + " clx:seen " + value("f");
    case 11:
      return variable("kl", 50) + " rdfs:subClassOf " + variable("kl", 50);
    default:
      return subject + " " + value("pq") + " " + value("xyz");
  }
}

/// Within a closure an alternative is a set; elsewhere it is a union, which keeps duplicates: see alternative().
std::string QueryGenerator::path(int depth) {
  const auto set = [&] {
    return chance(30) ? "(" + path(depth - 1) + "|" + path(depth - 1) + ")" : "(" + path(depth - 1) + ")";
  };
  if (depth <= 0 || chance(30))
    return one({"clx:near", "clx:hasPart", "clx:height", "rdfs:subClassOf", "a", "clx:pointCount"});
  switch (upTo(7)) {
    case 0:
      return path(depth - 1) + "/" + path(depth - 1);
    case 1:
      return set() + "*";
    case 2:
      return set() + "+";
    case 3:
      return set() + "?";
    case 4:
      return "^(" + path(depth - 1) + ")";
    case 5:
      return one({"!clx:near", "!(clx:near|a)", "!^a", "!(^a|^clx:near)"});
    default:
      return "a/rdfs:subClassOf*";
  }
}

/// The second engine drops duplicates of alternatives, so it gets the equivalent UNION of the specification.
std::string QueryGenerator::alternative(const std::string& subject, const std::string& object) {
  if (chance(20))
    return kOurs + subject + " !(^clx:near|clx:hasPart) " + object + " ." + kTheirs + "{ " + subject +
           " !clx:hasPart " + object + " } UNION { " + subject + " !^clx:near " + object + " }" + kEnd;
  const std::string left = path(1), right = path(1);
  return kOurs + subject + " " + left + "|" + right + " " + object + " ." + kTheirs + "{ " + subject + " " + left +
         " " + object + " } UNION { " + subject + " " + right + " " + object + " }" + kEnd;
}

std::string QueryGenerator::pathTriple() {
  const std::string subject = chance(75) ? variable("ab") : one({"o:1", "o:3", "clx:Tree"});
  const std::string object =
      chance(80) ? value(subject == "?a" ? "bcx" : "acx") : one({"o:2", "clx:Static", "clx:Plant"});
  if (chance(30)) return alternative(subject, object);
  return subject + " " + path(2) + " " + object + " .";
}

std::string QueryGenerator::triples() {
  std::string text;
  for (std::uint32_t n = 1 + upTo(3); n > 0 && patterns_left_ > 0; --n) {
    --patterns_left_;
    text += (chance(12) ? pathTriple() : triple() + " .") + " ";
  }
  return text;
}

std::string QueryGenerator::filter() {
  return no_filters_ ? "" : "FILTER(" + condition(2) + ") ";
}

std::string QueryGenerator::optional(int depth) {
  return "OPTIONAL { " + group(depth - 1) + "} ";
}

std::string QueryGenerator::unions(int depth) {
  std::string text = "{ " + group(depth - 1) + "}";
  for (std::uint32_t n = 1 + upTo(2); n > 0; --n) text += " UNION { " + group(depth - 1) + "}";
  return text + " ";
}

std::string QueryGenerator::minus(int depth) {
  return "MINUS { " + group(depth - 1) + "} ";
}

std::string QueryGenerator::graph(int depth) {
  const std::vector<std::string> graphs = madeGraphs();
  const std::string name =
      chance(60) ? variable("g") : "<" + graphs[1 + upTo(static_cast<std::uint32_t>(graphs.size()) - 1)] + ">";
  const bool around = std::exchange(in_graph_, true);
  const std::string text = "GRAPH " + name + " { " + group(depth - 1) + "} ";
  in_graph_ = around;
  return text;
}

std::string QueryGenerator::bind() {
  const std::string expression = one({number(2), string(2), anything(2), condition(1)});
  return "BIND(" + expression + " AS " + fresh() + ") ";
}

std::string QueryGenerator::values() {
  if (in_graph_) return {};
  if (chance(50)) return "VALUES " + variable("ab") + " { o:1 o:2 o:3 o:3 } ";
  return "VALUES (" + variable("k") + " " + variable("n") + ") { (clx:Tree UNDEF) (clx:Car 3) (UNDEF 2.5) } ";
}

std::string QueryGenerator::exists() {
  const std::vector<std::string> before = used_;
  std::string text = (chance(50) ? "EXISTS { " : "NOT EXISTS { ") + triple() + " . ";
  if (chance(30)) text += "FILTER(" + comparison(1) + ") ";
  used_ = before;
  return text + "}";
}

std::string QueryGenerator::subSelect(int depth) {
  const std::vector<std::string> before = std::exchange(used_, {});
  const std::string body = chance(40) ? aggregateSelect(depth - 1) : std::string();
  std::string text;
  std::vector<std::string> columns;
  if (body.empty()) {
    const std::string pattern = group(depth - 1);
    columns = used_;
    if (columns.size() > 2) columns.resize(2);
    text = std::string("SELECT ") + (chance(40) ? "DISTINCT " : "") + (columns.empty() ? "*" : joined(columns, " ")) +
           " { " + pattern + "}";
  } else {
    columns = used_;
    text = body;
  }
  used_ = before;
  for (const std::string& column : columns) used(column);
  return "{ " + text + " } ";
}

std::string QueryGenerator::aggregate() {
  const std::string distinct = chance(30) ? "DISTINCT " : "";
  switch (upTo(7)) {
    case 0:
      return "COUNT(*)";
    case 1:
      return "COUNT(" + distinct + anyVariable() + ")";
    case 2:
      return "SUM(" + distinct + variable(kNumbers) + ")";
    case 3:
      return "AVG(" + distinct + variable(kNumbers) + ")";
    case 4:
      return "MIN(COALESCE(" + variable(kNumbers) + ", 99))";
    case 5:
      return "MAX(COALESCE(" + variable(kNumbers) + ", -99))";
    default:
      return "STRLEN(GROUP_CONCAT(" + distinct + "COALESCE(STR(" + variable(kStrings) + "), \"-\"); SEPARATOR=\"|\"))";
  }
}

/// Stores the columns in used_.
std::string QueryGenerator::aggregateSelect(int depth) {
  const bool one_group = chance(30);
  const bool around = std::exchange(no_filters_, no_filters_ || one_group);
  const std::string pattern = triples() + group(depth);
  no_filters_ = around;
  std::vector<std::string> keys, columns;
  for (const std::string& name : used_)
    if (!one_group && keys.size() < 2 && chance(35)) keys.push_back(name);
  if (keys.empty() && !one_group) keys.push_back(anyVariable());
  std::string items;
  for (std::uint32_t n = 1 + upTo(2); n > 0; --n) {
    const std::string made = aggregate();
    columns.push_back("?r" + std::to_string(++fresh_));
    items += " (" + made + " AS " + columns.back() + ")";
  }
  std::string text = "SELECT " + joined(keys, " ") + items + " { " + pattern + "}";
  if (!keys.empty()) text += " GROUP BY " + joined(keys, " ");
  if (chance(25))
    text += " HAVING (" + one({"COUNT(*)", "COUNT(" + anyVariable() + ")"}) + " > " + std::to_string(upTo(4)) + ")";
  columns.insert(columns.begin(), keys.begin(), keys.end());
  used_ = columns;
  return text;
}

std::string QueryGenerator::groupElement(int depth) {
  if (depth <= 0) return chance(50) ? triples() : filter();
  switch (upTo(14)) {
    case 0:
    case 1:
    case 2:
      return optional(depth);
    case 3:
    case 4:
      return unions(depth);
    case 5:
      return in_graph_ ? optional(depth) : minus(depth);
    case 6:
    case 7:
      return graph(depth);
    case 8:
      return bind();
    case 9:
      return values();
    case 10:
      return in_graph_ ? unions(depth) : subSelect(depth);
    default:
      return filter();
  }
}

std::string QueryGenerator::group(int depth) {
  std::string text = chance(92) ? triples() : "";
  for (std::uint32_t n = upTo(3); n > 0; --n) text += groupElement(depth);
  return text;
}

void QueryGenerator::addModifiers(MadeQuery& query, const std::vector<std::string>& columns) {
  for (const std::string& column : columns) {
    const bool number = column.size() == 2 && std::string(kNumbers).find(column[1]) != std::string::npos;
    if (!number || !chance(40)) continue;
    query.ordered_by = column.substr(1);
    query.descending = chance(50);
    query.text += std::string(" ORDER BY ") + (query.descending ? "DESC(" : "ASC(") + column + ")";
    break;
  }
  if (!chance(20)) return;
  query.unlimited = query.text;
  query.text += " LIMIT " + std::to_string(upTo(12));
  if (chance(30)) query.text += " OFFSET " + std::to_string(upTo(5));
}

MadeQuery QueryGenerator::select() {
  MadeQuery query;
  if (chance(25)) {
    query.text = kPrologue + aggregateSelect(2);
    addModifiers(query, {});
    return query;
  }
  const std::string pattern = group(3);
  std::vector<std::string> columns;
  for (const std::string& name : used_)
    if (chance(75)) columns.push_back(name);
  const bool all = columns.empty() || chance(20);
  std::string items = all ? "*" : joined(columns, " ");
  if (!all && chance(15)) items += " (" + one({number(1), string(1), anything(1)}) + " AS ?r0)";
  query.text = kPrologue + "SELECT " + (chance(30) ? "DISTINCT " : "") + items + " { " + pattern + "}";
  addModifiers(query, columns);
  return query;
}

MadeQuery QueryGenerator::construct() {
  MadeQuery query;
  query.form = MadeForm::Construct;
  const std::string pattern = group(2);
  const std::string object = anyVariable();
  const std::string head =
      chance(70) ? variable("ab") + " clx:found " + object : "[] clx:found " + object + " ; clx:of " + variable("ab");
  query.text = kPrologue + "CONSTRUCT { " + head + " } { " + pattern + "}";
  return query;
}

MadeQuery QueryGenerator::next() {
  used_.clear();
  fresh_ = 0;
  in_graph_ = no_filters_ = false;
  patterns_left_ = 6;
  const std::uint32_t kind = upTo(20);
  if (kind == 0) return construct();
  if (kind > 1) return select();
  MadeQuery query;
  query.form = MadeForm::Ask;
  query.text = kPrologue + "ASK { " + group(3) + "}";
  return query;
}

}  // namespace cluxel::test
