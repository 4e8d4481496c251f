// SPDX-License-Identifier: Apache-2.0
// librdf streams of statements with contexts, and iterators over nodes.
#include "rdf/redland/redland_streams.hpp"

#include <new>

namespace cluxel::rdf {

namespace {

/// Holds a reference to the storage for the lifetime of a stream.
class StorageReference {
 public:
  explicit StorageReference(librdf_storage* storage) : storage_(storage) { librdf_storage_add_reference(storage); }
  StorageReference(const StorageReference&) = delete;
  StorageReference& operator=(const StorageReference&) = delete;
  ~StorageReference() { librdf_storage_remove_reference(storage_); }

 private:
  librdf_storage* storage_;
};

/// The current statement and context; owned here until the stream advances.
struct StatementStream {
  librdf_world* world;
  StorageReference storage;
  std::unique_ptr<RedlandMatches> matches;
  Redland<librdf_statement> statement;
  Redland<librdf_node> context;

  StatementStream(librdf_world* in, librdf_storage* of, std::unique_ptr<RedlandMatches> from)
      : world(in), storage(of), matches(std::move(from)) {}

  void move() {
    statement.reset();
    context.reset();
    matches->next();
  }

  librdf_statement* current() {
    if (statement) return statement.get();
    const QuadIds& quad = matches->quad();
    statement.reset(librdf_new_statement_from_nodes(world, nodeOf(world, matches->viewOf(quad.s)).release(),
                                                    nodeOf(world, matches->viewOf(quad.p)).release(),
                                                    nodeOf(world, matches->viewOf(quad.o)).release()));
    return statement.get();
  }

  /// Null for the unnamed graph.
  librdf_node* currentContext() {
    if (!context && matches->quad().g != kNoTerm) context = nodeOf(world, matches->viewOf(matches->quad().g));
    return context.get();
  }
};

int streamAtEnd(void* stream) {
  return static_cast<StatementStream*>(stream)->matches->atEnd() ? 1 : 0;
}

int streamNext(void* raw) {
  auto* stream = static_cast<StatementStream*>(raw);
  return guarded(stream->world, 1, [&] {
    stream->move();
    return stream->matches->atEnd() ? 1 : 0;
  });
}

void* streamGet(void* raw, int what) {
  auto* stream = static_cast<StatementStream*>(raw);
  return guarded(stream->world, static_cast<void*>(nullptr), [&]() -> void* {
    if (stream->matches->atEnd()) return nullptr;
    if (what == LIBRDF_STREAM_GET_METHOD_GET_OBJECT) return stream->current();
    if (what == LIBRDF_STREAM_GET_METHOD_GET_CONTEXT) return stream->currentContext();
    return nullptr;
  });
}

void streamFinished(void* stream) {
  delete static_cast<StatementStream*>(stream);
}

/// Iterates over nodes collected in advance.
struct NodeIterator {
  librdf_world* world;
  StorageReference storage;
  std::vector<Term> nodes;
  std::size_t place = 0;
  Redland<librdf_node> node;

  NodeIterator(librdf_world* in, librdf_storage* of, std::vector<Term> from)
      : world(in), storage(of), nodes(std::move(from)) {}
};

int iteratorAtEnd(void* raw) {
  const auto* iterator = static_cast<NodeIterator*>(raw);
  return iterator->place >= iterator->nodes.size() ? 1 : 0;
}

int iteratorNext(void* raw) {
  auto* iterator = static_cast<NodeIterator*>(raw);
  iterator->node.reset();
  if (iterator->place < iterator->nodes.size()) ++iterator->place;
  return iteratorAtEnd(raw);
}

void* iteratorGet(void* raw, int what) {
  auto* iterator = static_cast<NodeIterator*>(raw);
  return guarded(iterator->world, static_cast<void*>(nullptr), [&]() -> void* {
    if (what != LIBRDF_ITERATOR_GET_METHOD_GET_OBJECT || iteratorAtEnd(raw) != 0) return nullptr;
    if (!iterator->node) iterator->node = nodeOf(iterator->world, TermView::of(iterator->nodes[iterator->place]));
    return iterator->node.get();
  });
}

void iteratorFinished(void* iterator) {
  delete static_cast<NodeIterator*>(iterator);
}

}  // namespace

void logFailure(librdf_world* world, const std::exception& error) {
  librdf_log_simple(world, 0, LIBRDF_LOG_ERROR, LIBRDF_FROM_STORAGE, nullptr, error.what());
}

librdf_stream* streamOf(librdf_world* world, librdf_storage* storage, std::unique_ptr<RedlandMatches> matches) {
  auto context = std::make_unique<StatementStream>(world, storage, std::move(matches));
  librdf_stream* stream = librdf_new_stream(world, context.get(), streamAtEnd, streamNext, streamGet, streamFinished);
  if (stream == nullptr) throw std::bad_alloc();
  static_cast<void>(context.release());  // owned by the stream
  return stream;
}

librdf_iterator* iteratorOf(librdf_world* world, librdf_storage* storage, std::vector<Term> nodes) {
  auto context = std::make_unique<NodeIterator>(world, storage, std::move(nodes));
  librdf_iterator* iterator =
      librdf_new_iterator(world, context.get(), iteratorAtEnd, iteratorNext, iteratorGet, iteratorFinished);
  if (iterator == nullptr) throw std::bad_alloc();
  static_cast<void>(context.release());  // owned by the iterator
  return iterator;
}

}  // namespace cluxel::rdf
