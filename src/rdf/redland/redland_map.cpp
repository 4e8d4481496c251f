// SPDX-License-Identifier: Apache-2.0
// Queries and changes of the Redland storage.
#include "rdf/redland/redland_map.hpp"

#include <stdexcept>

#include "cluxel/error.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

/// A build computes these graphs. What is removed there would be missing until the next build.
void requireRemovable(const Term& graph) {
  using namespace vocabulary;
  for (const std::string_view built : {kGraphOntology, kGraphObserved, kGraphInferred, kGraphHistory})
    if (graph.text == built)
      throw Error(ErrorKind::InvalidArgument,
                  "nothing was removed: graph <" + graph.text +
                      "> is what a build made of scans, rules and ontology. Change these, or state what holds "
                      "instead in graph <" +
                      std::string(kGraphOperator) + ">; statements there can be removed");
}

}  // namespace

RedlandMatches::RedlandMatches(QuadReader reader, const QuadPattern& pattern, std::function<bool(QuadIds&)> accept,
                               bool copy)
    : reader_(std::move(reader)), cursor_(reader_->scan(pattern)), accept_(std::move(accept)) {
  if (copy) copyAll();
  next();
}

void RedlandMatches::copyAll() {
  std::vector<QuadIds> quads;
  for (QuadIds quad; take(quad);) {
    quads.push_back(quad);
    for (const TermId id : {quad.s, quad.p, quad.o, quad.g})
      if (const auto [term, is_new] = copied_terms_.try_emplace(id); is_new) term->second = reader_->termOf(id);
  }
  copied_ = std::move(quads);
  cursor_ = QuadCursor();
  reader_.reset();
}

TermView RedlandMatches::viewOf(TermId id) const {
  return reader_ ? reader_->viewOf(id) : TermView::of(copied_terms_.at(id));
}

bool RedlandMatches::take(QuadIds& quad) {
  while (cursor_.next(quad))
    if (accept_(quad)) return true;
  return false;
}

void RedlandMatches::next() {
  if (!copied_) {
    at_end_ = !take(quad_);
    return;
  }
  at_end_ = place_ == copied_->size();
  if (!at_end_) quad_ = (*copied_)[place_++];
}

void RedlandMap::open() {
  if (isOpen()) return;
  if (options_.create) {
    environment_ = Environment::open(options_.file, OpenMode::Create);
    return;
  }
  environment_ = Environment::open(options_.file, options_.write ? OpenMode::ReadWrite : OpenMode::ReadOnly);
}

void RedlandMap::close() {
  rollBack();
  environment_.reset();
}

ReadTransaction RedlandMap::read() {
  if (!isOpen()) throw std::logic_error("the storage is not open");
  if (!transaction_) return environment_->read();
  writer_->flush();
  return *transaction_;
}

void RedlandMap::begin(void* handle) {
  if (transaction_) throw Error(ErrorKind::StoreUnavailable, options_.file + ": a transaction is open already");
  if (!isOpen()) throw std::logic_error("the storage is not open");
  transaction_ = environment_->write();
  writer_ = std::make_unique<QuadWriter>(*transaction_);
  handle_ = handle;
}

void RedlandMap::commit() {
  if (!transaction_) throw Error(ErrorKind::StoreUnavailable, options_.file + ": no transaction is open");
  writer_->flush();
  transaction_->commit();
  rollBack();
}

void RedlandMap::rollBack() {
  writer_.reset();
  transaction_.reset();
  handle_ = nullptr;
}

void RedlandMap::change(const std::function<void(QuadWriter&)>& changes) {
  if (transaction_) return changes(*writer_);
  begin(nullptr);
  try {
    changes(*writer_);
    commit();
  } catch (...) {
    rollBack();
    throw;
  }
}

std::unique_ptr<RedlandMatches> RedlandMap::match(const Term* s, const Term* p, const Term* o, const Term* graph,
                                                  bool whole) {
  QuadReader reader(read());
  QuadPattern pattern;
  bool known = true;
  const auto bind = [&](std::optional<TermId>& position, const Term* term) {
    if (term == nullptr) return;
    position = reader.idOf(*term);
    known = known && position.has_value();
  };
  bind(pattern.s, s);
  bind(pattern.p, p);
  bind(pattern.o, o);
  bind(pattern.g, graph);
  if (graph == nullptr && options_.strict) pattern.g = kNoTerm;
  const TermId history = reader.idOf(Term::iri(vocabulary::kGraphHistory)).value_or(kNoTerm);
  const bool once = !whole && !pattern.g;
  const auto accept = [known, once, history, last = QuadIds{}](QuadIds& quad) mutable {
    if (!known || (once && history != kNoTerm && quad.g == history)) return false;
    const bool repeated = once && quad.s == last.s && quad.p == last.p && quad.o == last.o;
    last = quad;
    return !repeated;
  };
  return std::make_unique<RedlandMatches>(std::move(reader), known ? pattern : QuadPattern{1, 1, 1, 1}, accept,
                                          inTransaction());
}

std::unique_ptr<RedlandMatches> RedlandMap::find(const Term* s, const Term* p, const Term* o) {
  return match(s, p, o, nullptr, false);
}

std::unique_ptr<RedlandMatches> RedlandMap::findIn(const Term& graph, const Term* s, const Term* p, const Term* o) {
  return match(s, p, o, &graph, false);
}

std::unique_ptr<RedlandMatches> RedlandMap::all() {
  return match(nullptr, nullptr, nullptr, nullptr, true);
}

void RedlandMap::remove(const Term& s, const Term& p, const Term& o) {
  change([&](QuadWriter& writer) {
    writer.flush();
    const QuadReader reader(read());
    const auto found = match(&s, &p, &o, nullptr, true);
    const TermId history = reader.idOf(Term::iri(vocabulary::kGraphHistory)).value_or(kNoTerm);
    std::vector<QuadIds> quads;
    for (; !found->atEnd(); found->next())
      if (history == kNoTerm || found->quad().g != history) quads.push_back(found->quad());
    for (const QuadIds& quad : quads) requireRemovable(reader.termOf(quad.g));
    for (const QuadIds& quad : quads) writer.remove(quad);
  });
}

void RedlandMap::removeFrom(const Quad& quad) {
  requireRemovable(quad.graph);
  change([&](QuadWriter& writer) {
    writer.remove({writer.intern(quad.subject), writer.intern(quad.predicate), writer.intern(quad.object),
                   writer.intern(quad.graph)});
  });
}

void RedlandMap::removeContext(const Term& graph) {
  requireRemovable(graph);
  change([&](QuadWriter& writer) { writer.clearGraph(writer.intern(graph)); });
}

}  // namespace cluxel::rdf
