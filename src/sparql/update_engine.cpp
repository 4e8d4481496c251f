// SPDX-License-Identifier: Apache-2.0
// SPARQL 1.1 Update: executes operations in sequence; each sees the effects of the earlier ones.
#include "sparql/update_engine.hpp"

#include <algorithm>
#include <map>
#include <random>

#include "base/content_hash.hpp"
#include "rdf/store/flush_poll.hpp"
#include "sparql/syntax/parser.hpp"
#include "sparql/syntax/source_text.hpp"
#include "sparql/update/stored_changes.hpp"

namespace cluxel::sparql {
namespace {

bool mentionsBnode(std::string_view text) {
  constexpr std::string_view word = "bnode";
  const auto same = [](char a, char b) { return (a | 0x20) == b; };
  return std::search(text.begin(), text.end(), word.begin(), word.end(), same) != text.end();
}

class UpdateRun {
 public:
  UpdateRun(rdf::WriteTransaction& transaction, const ast::Update& update, const UpdateOptions& options,
            const Guard& guard)
      : transaction_(transaction),
        update_(update),
        options_(options),
        writer_(transaction),
        random_(options.query.seed ? *options.query.seed : std::random_device{}()),
        label_prefix_(freshPrefix()) {
    guard_ = guard;
  }

  UpdateReport run() {
    for (const ast::UpdateOperation& operation : update_.operations) {
      operation_ = &operation;
      const std::size_t held = guard_.usage().bytes;
      std::visit([this](const auto& part) { perform(part); }, operation.value);
      guard_.holdOnly(held);
    }
    return report_;
  }

 private:
  void perform(const ast::Load& load);
  void noteNothingLoaded(const ast::Load& load, const std::string& why);
  void perform(const ast::Clear& clear) { clearTarget(clear.target); }
  void perform(const ast::Drop& drop) { clearTarget(drop.target); }
  void perform(const ast::Create& create);
  void perform(const ast::Transfer& transfer);
  void perform(const ast::DataUpdate& data);
  void perform(const ast::Modify& modify);

  [[noreturn]] void fail(const std::string& message, const std::string& hint = {}, Remedy remedy = Remedy::None) const {
    failAt(options_.query.source_name, update_.text, operation_->at, message, hint, remedy);
  }

  /// The target graph of templates and DATA without GRAPH.
  Term defaultGraph() const {
    if (options_.any_graph_writable || options_.writable_graphs.empty()) return Term::iri("");
    return Term::iri(options_.writable_graphs.front());
  }
  void checkWritable(const Term& graph) const {
    const auto& open = options_.writable_graphs;
    if (options_.any_graph_writable || std::find(open.begin(), open.end(), graph.text) != open.end()) return;
    std::string list;
    for (const std::string& name : open) list += (list.empty() ? "<" : ", <") + name + ">";
    fail("the graph <" + graph.text + "> may not be written", "open for writing: " + (list.empty() ? "none" : list));
  }
  Term targetGraph(const ast::GraphTarget& target) const {
    return target.kind == ast::GraphTarget::Kind::Default ? defaultGraph() : target.graph;
  }
  void checkRemovable(const rdf::QuadReader& reader, const std::vector<ChangedQuad>& removals);
  void apply(const rdf::QuadReader& reader, const Changes& changes);
  void clearTarget(const ast::GraphTarget& target);
  std::vector<Quad> quadsOf(const Term& graph);
  std::string freshPrefix();
  std::vector<std::string> blankLabels() const;
  std::string freshLabel() { return label_prefix_ + std::to_string(++fresh_labels_); }

  rdf::WriteTransaction& transaction_;
  const ast::Update& update_;
  const UpdateOptions& options_;
  rdf::QuadWriter writer_;
  std::mt19937_64 random_;
  std::string label_prefix_;
  std::uint64_t fresh_labels_ = 0, modify_runs_ = 0;
  std::map<std::string, std::string> request_labels_;
  const ast::UpdateOperation* operation_ = nullptr;
  Guard guard_;
  UpdateReport report_;
};

/// The blank nodes of the writable graphs, sorted.
std::vector<std::string> UpdateRun::blankLabels() const {
  const rdf::QuadReader reader(transaction_);
  std::vector<std::string> labels;
  for (const std::string& graph : options_.writable_graphs) {
    rdf::QuadPattern pattern;
    pattern.g = reader.idOf(Term::iri(graph));
    if (!pattern.g) continue;
    rdf::QuadCursor cursor = reader.scan(pattern);
    for (rdf::QuadIds quad; cursor.next(quad);)
      for (const rdf::TermId id : {quad.s, quad.o})
        if (reader.valueOf(id).kind == TermKind::BlankNode) labels.emplace_back(reader.viewOf(id).text);
  }
  std::sort(labels.begin(), labels.end());
  return labels;
}

/// The label prefix of this request's blank nodes, which no stored label has. For a map it is derived from the request
/// and the writable graphs, so that equal sequences of requests give equal maps.
std::string UpdateRun::freshPrefix() {
  if (options_.any_graph_writable || options_.query.seed)
    return "u" + std::to_string(random_() % 1'000'000'000'000) + "x";
  // Computed on demand, because most requests create no blank nodes.
  const bool may_make = update_.text.find_first_of("[_\\") != std::string::npos || mentionsBnode(update_.text);
  const std::vector<std::string> labels = may_make ? blankLabels() : std::vector<std::string>();
  const auto isUsed = [&labels](const std::string& prefix) {
    const auto at = std::lower_bound(labels.begin(), labels.end(), prefix);
    return at != labels.end() && at->starts_with(prefix);
  };
  for (std::uint64_t request = 0;; ++request) {
    const std::string prefix =
        "u" + ContentHasher().addText(update_.text).add(request).finish().hex().substr(0, 16) + "x";
    if (!isUsed(prefix) && !isUsed("q" + prefix)) return prefix;
  }
}

/// SILENT lets the request go on, but whoever made it should know.
void UpdateRun::noteNothingLoaded(const ast::Load& load, const std::string& why) {
  report_.warnings.push_back({Severity::Warning,
                              {.file = options_.query.source_name},
                              "LOAD SILENT <" + load.source.text + "> loads nothing: " + why,
                              "",
                              ""});
}

void UpdateRun::perform(const ast::Load& load) {
  const Term graph = load.into.value_or(defaultGraph());
  checkWritable(graph);
  if (!options_.load) {
    if (load.silent) return noteNothingLoaded(load, "no file is named for it");
    fail("LOAD is refused", "name the file that it reads", Remedy::NameLoadFile);
  }
  Changes changes;
  try {
    for (Quad& quad : options_.load(load.source.text)) {
      quad.graph = graph;
      changes.inserted.push_back({std::move(quad)});
    }
  } catch (const Error& fault) {
    if (!load.silent) throw;
    noteNothingLoaded(load, fault.what());
  }
  apply(rdf::QuadReader(transaction_), changes);
}

std::vector<Quad> UpdateRun::quadsOf(const Term& graph) {
  std::vector<Quad> quads;
  const rdf::QuadReader reader(transaction_);
  const auto id = graph.text.empty() ? std::optional<rdf::TermId>(rdf::kNoTerm) : reader.idOf(graph);
  if (!id) return quads;
  rdf::QuadPattern pattern;
  pattern.g = *id;
  rdf::QuadCursor cursor = reader.scan(pattern);
  for (rdf::QuadIds quad; cursor.next(quad);) {
    guard_.work(1);
    guard_.charge(sizeof(ChangedQuad));
    quads.push_back({reader.termOf(quad.s), reader.termOf(quad.p), reader.termOf(quad.o), graph});
  }
  return quads;
}

void UpdateRun::clearTarget(const ast::GraphTarget& target) {
  using Kind = ast::GraphTarget::Kind;
  const rdf::QuadReader reader(transaction_);
  const auto clear = [&](const Term& graph) {
    checkWritable(graph);
    const auto id = graph.text.empty() ? std::optional<rdf::TermId>(rdf::kNoTerm) : reader.idOf(graph);
    if (!id) return;
    rdf::QuadPattern pattern;
    pattern.g = *id;
    report_.deleted += reader.count(pattern);
    writer_.clearGraph(*id);
    writer_.flush();
  };
  if (target.kind == Kind::Graph || target.kind == Kind::Default) return clear(targetGraph(target));
  std::vector<Term> graphs;
  for (const rdf::TermId graph : reader.graphs()) {
    if (graph != rdf::kNoTerm || target.kind == Kind::All) graphs.push_back(reader.termOf(graph));
  }
  for (const Term& graph : graphs) clear(graph);
}

void UpdateRun::perform(const ast::Create& create) {
  checkWritable(create.graph);
  // Empty graphs are not stored, so creating one has no effect.
  if (!create.silent && !quadsOf(create.graph).empty()) fail("the graph <" + create.graph.text + "> is there already");
}

void UpdateRun::perform(const ast::Transfer& transfer) {
  const Term from = targetGraph(transfer.from), to = targetGraph(transfer.to);
  checkWritable(to);
  if (transfer.kind == ast::Transfer::Kind::Move) checkWritable(from);
  if (from == to) return;
  std::vector<Quad> quads = quadsOf(from);
  if (quads.empty() && transfer.from.kind == ast::GraphTarget::Kind::Graph) {
    if (transfer.silent) return;
    fail("the graph <" + from.text + "> is not there");
  }
  Changes changes;
  const auto remove = [&](const Term& graph) {
    for (Quad& quad : quadsOf(graph)) changes.removed.push_back({std::move(quad)});
  };
  if (transfer.kind != ast::Transfer::Kind::Add) remove(to);
  if (transfer.kind == ast::Transfer::Kind::Move) remove(from);
  for (Quad& quad : quads) {
    quad.graph = to;
    changes.inserted.push_back({std::move(quad)});
  }
  apply(rdf::QuadReader(transaction_), changes);
}

void UpdateRun::perform(const ast::DataUpdate& data) {
  const rdf::QuadReader reader(transaction_);
  const auto fresh = [this](Term& term) {
    if (term.kind != TermKind::BlankNode) return;
    std::string& label = request_labels_[term.text];
    if (label.empty()) label = freshLabel();
    term.text = label;
  };
  Changes changes;
  for (Quad quad : data.quads) {
    const bool names_graph = !quad.graph.text.empty();
    if (!names_graph) quad.graph = defaultGraph();
    checkWritable(quad.graph);
    if (data.insert) {
      fresh(quad.subject);
      fresh(quad.object);
    }
    (data.insert ? changes.inserted : changes.removed).push_back({std::move(quad), names_graph});
  }
  checkRemovable(reader, changes.removed);
  apply(reader, changes);
}

std::string remedyForLocked() {
  return "what a build writes follows from scans, rules and ontology. To correct it, insert what holds instead (it "
         "goes "
         "to graph operator), state of an object that it is not of a class, or change rules or ontology and apply "
         "them. To delete operator statements alone, write "
         "GRAPH <" +
         std::string(rdf::vocabulary::kGraphOperator) +
         "> { ... } in the data or the template, or WITH before it. What follows from an operator statement goes when "
         "the statement is withdrawn";
}

void UpdateRun::checkRemovable(const rdf::QuadReader& reader, const std::vector<ChangedQuad>& removals) {
  if (options_.any_graph_writable || options_.query.default_graph == DefaultGraph::Unnamed) return;
  const auto locked = lockedTriples(reader, removals, options_.writable_graphs, guard_);
  if (!locked) return;
  const Quad& first = locked->first;
  const std::string remedy = options_.remedy_for ? options_.remedy_for(first) : "";
  fail(std::to_string(locked->count) + " of the " + std::to_string(locked->of) +
           " triples to delete lie in graphs that an update may not write, such as " + toNTriples(first.subject) + ' ' +
           toNTriples(first.predicate) + ' ' + toNTriples(first.object) + " in <" + first.graph.text +
           ">; nothing was changed",
       remedy.empty() ? remedyForLocked() : remedy);
}

void UpdateRun::apply(const rdf::QuadReader& reader, const Changes& changes) {
  if (options_.on_removal)
    for (const ChangedQuad& removal : changes.removed) {
      guard_.work(1);
      options_.on_removal(removal.quad);
    }
  const ChangeCounts counts = applyChanges(reader, writer_, changes, guard_);
  report_.inserted += counts.inserted;
  report_.deleted += counts.deleted;
}

void UpdateRun::perform(const ast::Modify& modify) {
  const rdf::QuadReader reader(transaction_);
  ModifyRun run(reader, update_, *operation_, modify, options_);
  run.label_prefix = label_prefix_ + "w" + std::to_string(++modify_runs_) + "x";
  run.seed = random_();
  run.default_graph = modify.with.value_or(defaultGraph());
  run.fresh_label = [this] { return freshLabel(); };
  run.used = guard_.usage();
  const Changes changes = run.changes();
  guard_.start(options_.query.budget, run.usedAfter());
  for (const ExpressionWarning& warning : run.warnings())
    report_.warnings.push_back(
        warningAt(options_.query.source_name, update_.text, warning.at, warning.message, warning.hint));
  for (const ChangedQuad& removal : changes.removed) checkWritable(removal.quad.graph);
  for (const ChangedQuad& insertion : changes.inserted) checkWritable(insertion.quad.graph);
  checkRemovable(reader, changes.removed);
  apply(reader, changes);
}

}  // namespace

UpdateReport runUpdate(rdf::WriteTransaction& transaction, std::string_view text, const UpdateOptions& given) {
  UpdateOptions options = given;
  options.query.budget.is_of_update = true;
  SparqlParseOptions parse_options;
  parse_options.file = options.query.source_name;
  parse_options.base_iri = options.query.base_iri;
  parse_options.prefixes = options.query.prefixes;
  Guard guard;
  guard.start(options.query.budget);
  parse_options.count = [&guard](std::size_t tokens) { guard.chargeForTokens(tokens); };
  const ast::Update update = parseUpdate(text, parse_options);
  const rdf::FlushPoll poll(transaction, [&guard] { guard.checkTime(); });
  return UpdateRun(transaction, update, options, guard).run();
}

}  // namespace cluxel::sparql
