// SPDX-License-Identifier: Apache-2.0
// What the JSON of an object tells beside its measures.
#include "serve/resources/object_json.hpp"

#include <gtest/gtest.h>

#include "rdf/file/environment.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::serve {
namespace {

TEST(JsonOfAnObject, TellsSinceWhenItIsGone) {
  const auto environment = rdf::Environment::temporary();
  {
    rdf::WriteTransaction transaction = environment->write();
    rdf::QuadWriter writer(transaction);
    writer.add({Term::iri("http://e/gone"), Term::iri(rdf::vocabulary::clx("seenThrough")),
                Term::literal("2023-11-15T22:13:20.000000Z", "http://www.w3.org/2001/XMLSchema#dateTime"),
                Term::iri(std::string(rdf::vocabulary::kGraphObserved))});
    writer.flush();
    transaction.commit();
  }
  const rdf::QuadReader quads(environment->read());
  Object gone, there;
  gone.iri = "http://e/gone", there.iri = "http://e/there";
  EXPECT_EQ(objectJson(gone, quads, {}).value("seenThrough", ""), "2023-11-15T22:13:20.000000Z");
  EXPECT_FALSE(objectJson(there, quads, {}).contains("seenThrough"));
}

}  // namespace
}  // namespace cluxel::serve
