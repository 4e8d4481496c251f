/* SPDX-License-Identifier: Apache-2.0
 * A program that knows only librdf: it opens a map and asks it a NOT EXISTS question. Cluxel comes in through
 * REDLAND_MODULE_PATH; nothing of it is included or linked here.
 *   librdf_only MAP QUERY      prints the first column, a line each */
#include <librdf.h>
#include <stdio.h>

static int ask(librdf_world* world, librdf_model* model, const char* text) {
  librdf_query* query = librdf_new_query(world, "cluxel", NULL, (const unsigned char*)text, NULL);
  librdf_query_results* results = query ? librdf_model_query_execute(model, query) : NULL;
  if (!results) return 1;
  for (; !librdf_query_results_finished(results); librdf_query_results_next(results)) {
    librdf_node* value = librdf_query_results_get_binding_value(results, 0);
    if (value && librdf_node_is_resource(value)) puts((const char*)librdf_uri_as_string(librdf_node_get_uri(value)));
    if (value) librdf_free_node(value);
  }
  librdf_free_query_results(results);
  librdf_free_query(query);
  return 0;
}

int main(int argc, char** argv) {
  librdf_world* world;
  librdf_storage* storage;
  librdf_model* model;
  int status = 1;
  if (argc != 3) return 2;
  world = librdf_new_world();
  librdf_world_open(world);
  storage = librdf_new_storage(world, "cluxel", argv[1], "write='no'");
  model = storage ? librdf_new_model(world, storage, NULL) : NULL;
  if (model) {
    status = ask(world, model, argv[2]);
    librdf_free_model(model);
  }
  if (storage) librdf_free_storage(storage);
  librdf_free_world(world);
  return status;
}
