// SPDX-License-Identifier: Apache-2.0
// The storage factory "cluxel": forwards librdf's callbacks to a RedlandMap.
#include "rdf/redland/redland_storage.hpp"

#include <librdf.h>

#include <rdf_storage_module.h>

#include <algorithm>

#include "base/ascii.hpp"
#include "base/utf8.hpp"
#include "rdf/redland/redland_calls.hpp"

namespace cluxel::rdf {

namespace {

using namespace redland_calls;

// A feature that only this storage has: the address of its RedlandMap, by which a query module finds the map.

bool flag(librdf_hash* options, const char* name, bool otherwise) {
  const Redland<char> value(options != nullptr ? librdf_hash_get(options, name) : nullptr);
  if (!value) return otherwise;
  const std::string_view text(value.get());
  return text == "yes" || text == "true" || text == "1";
}

int init(librdf_storage* storage, const char* name, librdf_hash* options) {
  librdf_world* world = librdf_storage_get_world(storage);
  const int result = guarded(world, 1, [&] {
    if (name == nullptr || *name == '\0')
      throw Error(ErrorKind::InvalidArgument, "the storage 'cluxel' needs the map's file as its name");
    RedlandOptions read{name, flag(options, "new", false), flag(options, "write", true),
                        flag(options, "strict", false)};
    librdf_storage_set_instance(storage, new RedlandMap(world, std::move(read)));
    return 0;
  });
  if (options != nullptr) librdf_free_hash(options);
  return result;
}

int clone(librdf_storage* copy, librdf_storage* original) {
  librdf_world* world = librdf_storage_get_world(original);
  return guarded(world, 1, [&] {
    RedlandOptions options = mapOf(original).options();
    options.create = false;
    librdf_storage_set_instance(copy, new RedlandMap(world, std::move(options)));
    return 0;
  });
}

void terminate(librdf_storage* storage) {
  delete static_cast<RedlandMap*>(librdf_storage_get_instance(storage));
  librdf_storage_set_instance(storage, nullptr);
}

int open(librdf_storage* storage, librdf_model*) {
  return run(storage, [](RedlandMap& map) { map.open(); });
}

int close(librdf_storage* storage) {
  return run(storage, [](RedlandMap& map) { map.close(); });
}

bool isPlain(std::string_view text, std::string_view more) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [more](char c) {
    return isAsciiAlphanumeric(c) || static_cast<unsigned char>(c) >= 0x80 || more.find(c) != std::string_view::npos;
  });
}

/// Refuses terms that no RDF syntax can represent: librdf can create them, but a map with them could not be exported
/// and read back.
void requireWritable(const Term& term) {
  const bool is_text = !firstInvalidUtf8(term.text) && term.text.find('\0') == std::string::npos;
  const bool is_label = term.kind != TermKind::BlankNode || isPlain(term.text, "_-");
  const bool is_tag = term.language.empty() || isPlain(term.language, "-");
  if (is_text && is_label && is_tag) return;
  throw Error(ErrorKind::FaultyInput,
              !is_text    ? "a term that is not UTF-8, or holds a zero byte, cannot be stored"
              : !is_label ? "the blank node '" + term.text + "' cannot be stored: use letters, digits, _ and -"
                          : "'" + term.language + "' is no language tag");
}

Quad addedQuad(librdf_statement* statement, librdf_node* context) {
  Quad quad = quadOf(statement, context);
  for (const Term* term : {&quad.subject, &quad.predicate, &quad.object, &quad.graph}) requireWritable(*term);
  return quad;
}

int addTo(librdf_storage* storage, librdf_node* context, librdf_statement* statement) {
  return run(storage, [&](RedlandMap& map) {
    const Quad quad = addedQuad(statement, context);
    map.change([&](QuadWriter& writer) { writer.add(quad); });
  });
}

int add(librdf_storage* storage, librdf_statement* statement) {
  return addTo(storage, nullptr, statement);
}

int addAllTo(librdf_storage* storage, librdf_node* context, librdf_stream* stream) {
  return run(storage, [&](RedlandMap& map) {
    map.change([&](QuadWriter& writer) {
      for (; librdf_stream_end(stream) == 0; librdf_stream_next(stream))
        if (librdf_statement* statement = librdf_stream_get_object(stream))
          writer.add(addedQuad(statement, context != nullptr ? context : librdf_stream_get_context2(stream)));
    });
  });
}

int addAll(librdf_storage* storage, librdf_stream* stream) {
  return addAllTo(storage, nullptr, stream);
}

int remove(librdf_storage* storage, librdf_statement* statement) {
  return run(storage, [&](RedlandMap& map) {
    const Quad quad = quadOf(statement, nullptr);
    map.remove(quad.subject, quad.predicate, quad.object);
  });
}

int removeFrom(librdf_storage* storage, librdf_node* context, librdf_statement* statement) {
  if (context == nullptr) return remove(storage, statement);
  return run(storage, [&](RedlandMap& map) { map.removeFrom(quadOf(statement, context)); });
}

int removeContext(librdf_storage* storage, librdf_node* context) {
  return run(storage,
             [&](RedlandMap& map) { map.removeContext(context != nullptr ? termOf(context) : Term::iri("")); });
}

// Nothing to do: every commit is synchronised to disk.
int sync(librdf_storage*) {
  return 0;
}

librdf_node* getFeature(librdf_storage* storage, librdf_uri* feature) {
  return on(storage, static_cast<librdf_node*>(nullptr), [&](RedlandMap& map) -> librdf_node* {
    const std::string_view name(reinterpret_cast<const char*>(librdf_uri_as_string(feature)));
    if (name == LIBRDF_MODEL_FEATURE_CONTEXTS) return nodeOf(map.world(), TermView::of(Term::literal("1"))).release();
    return nullptr;
  });
}

int setFeature(librdf_storage*, librdf_uri*, librdf_node*) {
  return -1;
}

int startWithHandle(librdf_storage* storage, void* handle) {
  return run(storage, [&](RedlandMap& map) { map.begin(handle); });
}

int start(librdf_storage* storage) {
  return startWithHandle(storage, nullptr);
}

int commit(librdf_storage* storage) {
  return run(storage, [](RedlandMap& map) { map.commit(); });
}

int rollBack(librdf_storage* storage) {
  return run(storage, [](RedlandMap& map) { map.rollBack(); });
}

void* transactionHandle(librdf_storage* storage) {
  return mapOf(storage).handle();
}

void fillFactory(librdf_storage_factory* factory) {
  factory->version = LIBRDF_STORAGE_INTERFACE_VERSION;
  factory->init = init;
  factory->clone = clone;
  factory->terminate = terminate;
  factory->open = open;
  factory->close = close;
  factory->size = size;
  factory->add_statement = add;
  factory->add_statements = addAll;
  factory->remove_statement = remove;
  factory->contains_statement = contains;
  factory->has_arc_in = hasArcIn;
  factory->has_arc_out = hasArcOut;
  factory->serialise = serialise;
  factory->find_statements = find;
  factory->find_statements_with_options = findWithOptions;
  factory->find_statements_in_context = findIn;
  factory->find_sources = findSources;
  factory->find_arcs = findArcs;
  factory->find_targets = findTargets;
  factory->get_arcs_in = arcsIn;
  factory->get_arcs_out = arcsOut;
  factory->context_add_statement = addTo;
  factory->context_add_statements = addAllTo;
  factory->context_remove_statement = removeFrom;
  factory->context_remove_statements = removeContext;
  factory->context_serialise = serialiseContext;
  factory->sync = sync;
  factory->get_contexts = contexts;
  factory->get_feature = getFeature;
  factory->set_feature = setFeature;
  factory->transaction_start = start;
  factory->transaction_start_with_handle = startWithHandle;
  factory->transaction_commit = commit;
  factory->transaction_rollback = rollBack;
  factory->transaction_get_handle = transactionHandle;
}

}  // namespace

void registerRedlandStorage(librdf_world_s* world) {
  librdf_storage_register_factory(world, "cluxel", "Cluxel map", fillFactory);
}

}  // namespace cluxel::rdf
