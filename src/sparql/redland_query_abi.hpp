// SPDX-License-Identifier: Apache-2.0
// The binary layout of librdf 1.0.17's query objects. librdf exports librdf_query_register_factory, but the structure
// that the registered function fills in stands in no installed header. The members below say what lies where, as the
// functions of the library use it; they were compared with the machine code of Debian's library
// (docs/decisions/sparql.md). registerRedlandQueries() uses them with that release only, and checks them against a
// factory of the library's own.
#pragma once

#include <librdf.h>

#include <cstddef>

namespace cluxel::redland_abi {

inline constexpr unsigned kKnownRelease = 10017;

struct Factory;

struct Query {
  librdf_world* world;
  int usage;
  void* context;  ///< Factory::context_length bytes of zeros at first
  Factory* factory;
  librdf_query_results* results;
};

/// What a results object begins with; ours goes on.
struct Results {
  Query* query;
  Results* next;
};

struct Formatter {
  Results* results;
  void* own;
};

struct Factory {
  librdf_world* world;
  Factory* next;
  char* name;
  librdf_uri* uri;
  std::size_t context_length;
  int (*init)(Query*, const char* name, librdf_uri* uri, const unsigned char* text, librdf_uri* base);
  int (*clone)(Query* made, Query* from);
  void (*terminate)(Query*);
  Results* (*execute)(Query*, librdf_model*);
  int (*get_limit)(Query*);
  int (*set_limit)(Query*, int);
  int (*get_offset)(Query*);
  int (*set_offset)(Query*, int);
  librdf_stream* (*results_as_stream)(Results*);
  int (*results_get_count)(Results*);
  int (*results_next)(Results*);
  int (*results_finished)(Results*);
  int (*results_get_bindings)(Results*, const char*** names, librdf_node** values);
  librdf_node* (*results_get_binding_value)(Results*, int);
  const char* (*results_get_binding_name)(Results*, int);
  librdf_node* (*results_get_binding_value_by_name)(Results*, const char*);
  int (*results_get_bindings_count)(Results*);
  void (*free_results)(Results*);
  int (*results_is_bindings)(Results*);
  int (*results_is_boolean)(Results*);
  int (*results_is_graph)(Results*);
  int (*results_is_syntax)(Results*);
  int (*results_get_boolean)(Results*);
  Formatter* (*new_formatter)(Results*, const char* name, const char* mime_type, librdf_uri* format);
  void (*free_formatter)(Formatter*);
  int (*formatter_write)(raptor_iostream*, Formatter*, Results*, librdf_uri* base);
};
static_assert(sizeof(void*) != 8 || sizeof(Factory) == 0xF8);

extern "C" {
/// librdf_query_register_factory with the factory's layout; one C function may not be declared with two types.
void registerQueryFactory(librdf_world* world, const char* name, const unsigned char* uri,
                          void (*fill)(Factory*)) asm("librdf_query_register_factory");
void librdf_log_simple(librdf_world* world, int code, librdf_log_level level, librdf_log_facility facility,
                       void* locator, const char* message);
Factory* librdf_get_query_factory(librdf_world* world, const char* name, librdf_uri* uri);
}

}  // namespace cluxel::redland_abi
