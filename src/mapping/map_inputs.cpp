// SPDX-License-Identifier: Apache-2.0
// Reading and hashing the inputs of a map.
#include "mapping/map_inputs.hpp"

#include <algorithm>
#include <tuple>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/vocabulary.hpp"
#include "rules/language/rule_loader.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

/// The text of a file that counts twice would make another map of the same inputs.
void requireDifferent(const std::vector<fs::path>& files) {
  std::error_code ignored;
  for (auto file = files.begin(); file != files.end(); ++file)
    if (std::any_of(files.begin(), file, [&](const fs::path& other) { return fs::equivalent(*file, other, ignored); }))
      throw Error(ErrorKind::InvalidArgument, file->string() + ": is named twice");
}

std::vector<NamedText> readAll(const std::vector<fs::path>& files) {
  requireDifferent(files);
  std::vector<NamedText> texts;
  texts.reserve(files.size());
  for (const fs::path& file : files) texts.push_back({file.string(), readFile(file)});
  return texts;
}

std::vector<fs::path> givenOr(const std::vector<fs::path>& given, const std::string& folder, std::string_view ending,
                              const DataHome& home) {
  if (given.empty()) return filesIn(home.locate(folder), {ending});
  std::vector<fs::path> files;
  files.reserve(given.size());
  for (const fs::path& name : given) files.push_back(home.locateFile(folder, name, ending));
  return files;
}

/// The given rule files and all that they include. Throws InputError with all faults when files cannot be read or do
/// not fit together; what they say is checked when the texts are loaded.
std::vector<NamedText> readRules(std::vector<fs::path> roots, const std::vector<NamedText>& ontology) {
  // Includes are resolved to absolute paths, so the roots must be absolute as well.
  for (fs::path& root : roots) root = fs::absolute(root).lexically_normal();
  auto sources = rules::readRuleSources(roots);
  if (!sources) sources = loadRules(roots, classCatalogueOf(ontology)).require().sources;
  std::vector<NamedText> texts = readAll(roots);
  for (const rules::RuleSource& source : *sources) {
    const auto isSame = [&](const NamedText& text) { return text.name == source.name; };
    if (std::none_of(texts.begin(), texts.end(), isSame)) texts.push_back({source.name, source.text});
  }
  return texts;
}

/// Each rule sees what earlier ones derived, so their order must not depend on how the files were given.
std::vector<NamedText> readSparqlRules(const std::vector<fs::path>& files) {
  std::vector<NamedText> rules = readAll(files);
  std::sort(rules.begin(), rules.end(), [](const NamedText& a, const NamedText& b) {
    const std::string name_a = ruleFileName(a), name_b = ruleFileName(b);
    return std::tie(name_a, a.text, a.name) < std::tie(name_b, b.text, b.name);
  });
  return rules;
}

void addTexts(ContentHasher& hasher, const std::vector<NamedText>& texts) {
  hasher.add(static_cast<std::uint64_t>(texts.size()));
  for (const NamedText& text : texts) hasher.addText(text.text);
}

}  // namespace

fs::path nameWithin(const fs::path& folder, const fs::path& file) {
  const fs::path relative = file.lexically_normal().lexically_relative(folder.lexically_normal());
  const bool is_below = !relative.empty() && std::find(relative.begin(), relative.end(), "..") == relative.end();
  return is_below ? relative : file.filename();
}

void describe(MapParams& params, perception::ParameterVisitor& visitor) {
  describe(params.labelling, visitor);
  describe(params.component, visitor);
  describe(params.contact, visitor);
  describe(params.relation, visitor);
}

ContentHash MapInputs::hash() const {
  ContentHasher hasher;
  addTexts(hasher, ontology);
  addTexts(hasher, rules);
  hasher.add(static_cast<std::uint64_t>(rule_roots));
  addTexts(hasher, sparql_rules);
  for (const NamedText& rule : sparql_rules) hasher.addText(ruleFileName(rule));  // the names occur in the map's facts
  hasher.add(kStagesVersion);
  hasher.addText(model.text).add(perception::hashOf(params)).addText(crs);
  for (int axis = 0; axis < 3; ++axis) hasher.add(map_origin[axis]);
  // Earlier versions had other tiles where the origin does not lie at whole ones.
  if (tileGrid() != perception::TileGrid()) hasher.addText("tiles of the outer frame");
  return hasher.finish();
}

std::string describeFiles(const MapInputs& inputs) {
  const fs::path home = inputs.home.empty() ? fs::path() : fs::absolute(inputs.home).lexically_normal();
  const auto shortName = [&](const NamedText& text) {
    const fs::path name = fs::path(text.name).lexically_relative(home);
    return home.empty() || name.empty() || *name.begin() == ".." ? text.name : name.string();
  };
  const auto listOf = [&](const std::vector<NamedText>& texts) {
    std::string names;
    for (const NamedText& text : texts) names += (names.empty() ? "" : ", ") + shortName(text);
    return names.empty() ? "none" : names;
  };
  return "data home " + (inputs.home.empty() ? "unknown" : inputs.home) + "; ontology " + listOf(inputs.ontology) +
         "; rules " + listOf(inputs.rules) + "; SPARQL rules " + listOf(inputs.sparql_rules) + "; model " +
         listOf({inputs.model});
}

std::string ruleFileName(const NamedText& rule) {
  return fs::path(rule.name).filename().string();
}

std::vector<rdf::RdfSource> ontologySources(const std::vector<NamedText>& texts) {
  std::vector<rdf::RdfSource> sources;
  sources.reserve(texts.size());
  for (const NamedText& text : texts)
    sources.push_back({text.text, text.name, rdf::RdfFormat::Turtle, std::string(rdf::vocabulary::kClx),
                       Term::iri(rdf::vocabulary::kGraphOntology)});
  return sources;
}

rdf::OntologyView ontologyOf(const std::vector<NamedText>& texts) {
  return ontologyViewOf(ontologySources(texts));
}

rules::ClassCatalogue classCatalogueOf(const std::vector<NamedText>& ontology) {
  return rules::catalogueOf(ontologyOf(ontology));
}

MapInputs readMapInputs(const MapInputFiles& files, const DataHome& home) {
  // A default name is never looked up in the working directory, where a file of that name may be unrelated.
  MapInputFiles all = files;
  all.ontology = givenOr(files.ontology, "ontology", ".ttl", home);
  if (files.rules.empty()) all.rules = {home.locate("rules/outdoor.rules.yaml")};
  all.sparql_rules = givenOr(files.sparql_rules, "rules", ".rq", home);
  if (files.model.empty()) all.model = home.locate("models/oakland");
  MapInputs inputs;
  inputs.home = home.root().string();
  return withNamedFiles(std::move(inputs), all, home);
}

MapInputs withNamedFiles(MapInputs inputs, const MapInputFiles& files, const DataHome& home) {
  if (!files.ontology.empty()) {
    inputs.ontology = readAll(givenOr(files.ontology, "ontology", ".ttl", home));
    checkOntology(ontologySources(inputs.ontology));
  }
  std::vector<fs::path> rules;
  for (const fs::path& name : files.rules) rules.push_back(home.locateFile("rules", name, ".rules.yaml"));
  if (!rules.empty()) {
    inputs.rules = readRules(rules, inputs.ontology);
    inputs.rule_roots = rules.size();
  }
  if (!files.sparql_rules.empty())
    inputs.sparql_rules = readSparqlRules(givenOr(files.sparql_rules, "rules", ".rq", home));
  if (files.model.empty()) return inputs;
  fs::path model = home.locate("models", files.model);
  if (fs::is_directory(model)) model /= "model.json";
  inputs.model = {model.string(), readFile(model)};
  return inputs;
}

}  // namespace cluxel::mapping
