// SPDX-License-Identifier: Apache-2.0
// `cluxel state`: what an operator states about objects and regions of a map.

#include "app/command.hpp"
#include "app/commands/change_report.hpp"
#include "app/commands/statement_list.hpp"
#include "app/shared_options.hpp"
#include "base/utf8.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/operator_statements.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/statements/applied_statements.hpp"
#include "mapping/statements/excluded_types.hpp"
#include "rdf/map_iris.hpp"
#include "rules/language/rule_loader.hpp"
#include "tasks/derived_classes.hpp"
#include "tasks/named_class.hpp"
#include "tasks/thing_names.hpp"

namespace cluxel::app {

namespace {

struct StateOptions {
  fs::path map, export_file;
  std::string object, is, is_not, label, note, author;
  std::vector<double> region;
  std::vector<std::string> withdrawn;
  bool remove = false, list = false;
  mapping::ChangeParams change;
};

using mapping::Statement;
using mapping::StatementKind;

void requireOneUse(const StateOptions& options) {
  const bool about_object = !options.is.empty() || !options.is_not.empty() || options.remove ||
                            !options.label.empty() || !options.note.empty();
  if (about_object && options.object.empty())
    throw Error(ErrorKind::InvalidArgument, "--is, --is-not, --remove, --label and --note need --object");
  if (!about_object && !options.object.empty())
    throw Error(ErrorKind::InvalidArgument,
                "--object: what is it? Add --is CLASS, --is-not CLASS, --remove, --label TEXT or --note TEXT");
  const int about_class = (options.is.empty() ? 0 : 1) + (options.is_not.empty() ? 0 : 1) + (options.remove ? 1 : 0);
  if (about_class > 1) throw Error(ErrorKind::InvalidArgument, "--is, --is-not and --remove exclude each other");
  const bool changes = about_object || !options.region.empty() || !options.withdrawn.empty();
  if (!changes && !options.list && options.export_file.empty())
    throw Error(ErrorKind::InvalidArgument,
                "state: nothing to do; name --object, --ignore-region, --withdraw, --list or --export");
  if (changes && (options.list || !options.export_file.empty()))
    throw Error(ErrorKind::InvalidArgument, "--list and --export read the map; give them without a statement");
}

std::vector<Eigen::Vector2d> cornersOf(const std::vector<double>& numbers) {
  if (numbers.size() == 4) {
    const double x0 = numbers[0], y0 = numbers[1], x1 = numbers[2], y1 = numbers[3];
    if (x0 == x1 || y0 == y1) throw Error(ErrorKind::InvalidArgument, "--ignore-region: the rectangle has no area");
    return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  }
  if (numbers.size() < 6 || numbers.size() % 2 != 0)
    throw Error(ErrorKind::InvalidArgument,
                "--ignore-region: write X0,Y0,X1,Y1 for a rectangle, or three corners X,Y or more, in metres");
  std::vector<Eigen::Vector2d> corners;
  for (std::size_t i = 0; i < numbers.size(); i += 2) corners.emplace_back(numbers[i], numbers[i + 1]);
  return corners;
}

/// The ground of a map is one object: what is said of its class would hold for all of it.
void refuseWholeClass(const mapping::MapReader& map, const ContentHash& id) {
  if (!map.isClassWide(id)) return;
  const rules::RuleSet rules = mapping::parseInputs(map.inputs()).rules;
  const rules::SemanticObject& object = map.objects()[tasks::objectNamed(map, id.hex())];
  std::size_t primitives = 0;
  for (const rules::ObjectPart& part : object.parts) primitives += part.primitives.size();
  throw Error(
      ErrorKind::InvalidArgument,
      "object/" + object.id.hex() + " is all " + rules.shorten(object.class_iri) + " of the map, " +
          std::to_string(primitives) +
          " primitives in one object: --is, --is-not and --remove would change all of it; --label and --note are "
          "possible");
}

/// What of an object an earlier statement may be replaced in: its class and its label, apart from labels in some
/// language.
enum class Single : std::uint8_t { Nothing, Class, Label };

Single singleOf(const Statement& statement) {
  switch (statement.kind) {
    case StatementKind::Is:
    case StatementKind::IsNot:
    case StatementKind::Remove:
      return Single::Class;
    case StatementKind::Fact:
      if (statement.property == rdf::vocabulary::rdfs("label") && statement.value.language.empty())
        return Single::Label;
      return Single::Nothing;
    default:
      return Single::Nothing;
  }
}

/// Whether the new statement takes the place of an earlier one about the same object. Of its class several may hold:
/// "is a barrier" and "is no fence". One that says the same of other points is replaced, too.
bool takesPlaceOf(const Statement& added, const Statement& earlier, const rules::ClassCatalogue& classes) {
  const Single single = singleOf(earlier);
  if (single == Single::Nothing || singleOf(added) != single || added.id() == earlier.id()) return false;
  const bool is_same = added.kind == earlier.kind && added.value == earlier.value;
  return single == Single::Label || is_same || !areCompatible(added, earlier, classes);
}

/// Withdraws earlier statements about the object in whose place new ones come.
/// Returns what is to be told when the change has succeeded.
std::vector<std::string> replaceEarlier(const mapping::MapReader& map, const ContentHash& object,
                                        mapping::StatementEdit& edit) {
  std::vector<std::string> notes;
  const rules::ClassCatalogue classes = mapping::parseInputs(map.inputs()).rules.catalogue;
  for (const mapping::KnownStatement& known : mapping::knownStatements(map.quads())) {
    if (known.object != rdf::iriOfObject(object)) continue;
    const ContentHash id = known.statement.id();
    if (std::none_of(edit.added.begin(), edit.added.end(),
                     [&](const Statement& added) { return takesPlaceOf(added, known.statement, classes); }))
      continue;
    edit.withdrawn.push_back(id);
    notes.push_back("replaces the statement " + id.hex() + ": " + textOf(known.statement));
  }
  return notes;
}

/// What SPARQL rules say of the object now and new statements rule out: the report tells of the other rules.
std::vector<std::string> whatIsRuledOut(const mapping::MapReader& map, const ContentHash& object,
                                        const mapping::StatementEdit& edit) {
  std::vector<std::string> notes;
  for (const tasks::DerivedClass& derived : tasks::derivedClassesOf(map.quads(), rdf::iriOfObject(object)))
    if (std::any_of(edit.added.begin(), edit.added.end(),
                    [&](const Statement& added) { return mapping::rulesOut(map.quads(), added, derived.class_iri); }))
      notes.push_back("before, SPARQL rule " + derived.file + " said of it " + classText(derived.class_iri));
  return notes;
}

/// The new statements about the object, and the earlier ones that they replace.
std::vector<std::string> addAboutObject(const mapping::MapReader& map, const StateOptions& options,
                                        mapping::StatementEdit& edit, ProgressSink& sink) {
  if (const std::string note = tasks::nameNote(map, options.object); !note.empty()) sink.note(note);
  const std::uint32_t number = tasks::objectNamed(map, options.object);
  const ContentHash object = map.objectIds()[number];
  const bool is_wide = map.isClassWide(object);
  const mapping::PointAnchor anchor = is_wide ? mapping::PointAnchor() : map.anchorOf(object);
  const std::string class_iri = is_wide ? map.classOf(number) : "";
  const auto add = [&](StatementKind kind, const std::string& property, const Term& value) {
    edit.added.push_back({kind, property, value, anchor, {}, class_iri});
  };
  const auto classOf = [&](const std::string& name) { return Term::iri(tasks::classNamed(map, name)); };
  if (!options.is.empty()) add(StatementKind::Is, "", classOf(options.is));
  if (!options.is_not.empty()) add(StatementKind::IsNot, "", classOf(options.is_not));
  if (options.remove) add(StatementKind::Remove, "", {});
  if (!edit.added.empty()) refuseWholeClass(map, object);
  if (!options.label.empty()) add(StatementKind::Fact, rdf::vocabulary::rdfs("label"), Term::literal(options.label));
  if (!options.note.empty()) add(StatementKind::Fact, rdf::vocabulary::rdfs("comment"), Term::literal(options.note));
  std::vector<std::string> notes = replaceEarlier(map, object, edit);
  const std::vector<std::string> ruled_out = whatIsRuledOut(map, object, edit);
  notes.insert(notes.end(), ruled_out.begin(), ruled_out.end());
  return notes;
}

ExitCode change(const StateOptions& options, Session& session) {
  mapping::requireChangeable(options.map, options.change);
  mapping::StatementEdit edit;
  std::vector<std::string> notes;
  edit.author = authorOr(options.author);
  {
    const mapping::MapReader map(options.map);
    if (!options.object.empty()) notes = addAboutObject(map, options, edit, session.console);
    if (!options.region.empty())
      edit.added.push_back(
          {StatementKind::IgnoreRegion, "", {}, {}, regionAnchor(map.clouds(), cornersOf(options.region))});
    for (const std::string& name : options.withdrawn)
      edit.withdrawn.push_back(mapping::statementNamed(map.quads(), name));
  }
  mapping::ChangeParams params = options.change;
  params.threads = session.threadCount();
  const mapping::ChangeReport report = changeStatements(options.map, edit, params, session.console);
  for (const std::string& note : notes) session.console.note(note);
  if (!session.json)
    for (const mapping::StatementOutcome& outcome : report.statements)
      for (const Statement& added : edit.added)
        if (added.id() == outcome.statement.id()) print(withoutControls(lineOf(outcome)));
  printChange(options.map, report, params, session);
  return ExitCode::Done;
}

ExitCode exportStatements(const StateOptions& options, const mapping::MapReader& map) {
  std::vector<std::string> lines;
  for (const Quad& quad : mapping::operatorStatements(map.quads())) lines.push_back(toNQuads(quad));
  std::sort(lines.begin(), lines.end());
  std::string text;
  for (const std::string& line : lines) text += line;
  refuseToReplaceMap(options.export_file);
  writeOutput(options.export_file, text);
  return ExitCode::Done;
}

ExitCode state(const StateOptions& options, Session& session) {
  requireOneUse(options);
  if (!options.list && options.export_file.empty()) return change(options, session);
  const mapping::MapReader map(options.map);
  if (!options.export_file.empty()) exportStatements(options, map);
  if (options.list) printStatements(mapping::knownStatements(map.quads()), session);
  return ExitCode::Done;
}

}  // namespace

void addState(CLI::App& app, Session& session) {
  auto options = std::make_shared<StateOptions>();
  CLI::App* command = app.add_subcommand("state", "state what an object of a map is, or that it is no object");
  command->add_option("map", options->map, "a finished map")->required();
  command->add_option("--object", options->object, "the object: its IRI, number or hash, as for `explain`");
  command->add_option("--is", options->is, "state its class");
  command->add_option("--is-not", options->is_not, "state a class that it does not have");
  command->add_flag("--remove,--ignore", options->remove, "state that it is no object");
  command->add_option("--label", options->label, "state its name (rdfs:label)")->check(validText());
  command->add_option("--note", options->note, "add a remark about it (rdfs:comment)")->check(validText());
  command
      ->add_option("--ignore-region", options->region,
                   "X0,Y0,X1,Y1 or a polygon X,Y,X,Y,X,Y… [m, map]: state that nothing in it is an object")
      ->delimiter(',')
      ->check(finite());
  command->add_option("--withdraw", options->withdrawn, "take back a statement: the first digits of its id");
  addAuthor(*command, options->author);
  command->add_flag("--list", options->list, "list the statements, and whether each was applied");
  command->add_option("--export", options->export_file, "write the statements as N-Quads, for build --statements");
  addChangeOptions(*command, options->change, false);
  onRun(*command, session, [options, &session] { return state(*options, session); });
}

}  // namespace cluxel::app
