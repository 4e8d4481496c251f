// SPDX-License-Identifier: Apache-2.0
// A poll sees every part of a large flush, and ends it.
#include "rdf/store/flush_poll.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "cluxel/error.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {
namespace {

constexpr int kManyQuads = 20'000;

Quad quadOf(int number, const std::string& property) {
  return {Term::iri("http://x/" + std::to_string(number * 7919 % kManyQuads)), Term::iri("http://x/" + property),
          Term::integer(number), Term::iri("")};
}

/// Three sorts of flush: into an empty store, a rewritten index, and single entries beside many.
class FlushPolls : public testing::TestWithParam<std::string> {
 protected:
  static void change(QuadWriter& writer, const QuadReader& reader) {
    if (GetParam() == "remove") {
      QuadCursor cursor = reader.scan({});
      for (QuadIds quad; cursor.next(quad);) writer.remove(quad);
      return;
    }
    for (int i = 0; i < kManyQuads; ++i) writer.add(quadOf(i, GetParam()));
  }
  void SetUp() override {
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    const int before = GetParam() == "first" ? 0 : GetParam() == "beside" ? 6 * kManyQuads : kManyQuads;
    for (int i = 0; i < before; ++i) writer.add(quadOf(i, "before"));
    writer.flush();
    transaction.commit();
  }

  /// Some indexes may have the change and others not, as after an error on a full disk.
  static void expectGivenUp(WriteTransaction& transaction) {
    EXPECT_THROW(QuadReader(static_cast<const ReadTransaction&>(transaction)).size(), Error);
    EXPECT_THROW(QuadWriter(transaction).add(quadOf(1, "again")), Error);
    EXPECT_THROW(transaction.commit(), Error);
  }

  std::shared_ptr<Environment> environment = Environment::temporary();
};

TEST_P(FlushPolls, EndAFlushAtEachOfTheirCalls) {
  const std::uint64_t before = QuadReader(environment->read()).size();
  int calls = 0;
  const auto run = [&](int last_call) {
    calls = 0;
    WriteTransaction transaction = environment->write();
    const FlushPoll poll(transaction, [&] {
      if (++calls == last_call) throw std::runtime_error("enough");
    });
    QuadWriter writer(transaction);
    change(writer, QuadReader(static_cast<const ReadTransaction&>(transaction)));
    EXPECT_EQ(calls, 0) << "nothing was flushed yet";
    try {
      writer.flush();
    } catch (const std::runtime_error&) {
      expectGivenUp(transaction);
      throw;
    }
  };
  EXPECT_NO_THROW(run(0));
  const int all = calls;
  EXPECT_GE(all, 4 * (kManyQuads / 4096)) << "three indexes, and the search for literals, of which the fourth has none";
  for (int last = 1; last <= all; ++last) {
    EXPECT_THROW(run(last), std::runtime_error) << "call " << last;
    EXPECT_EQ(QuadReader(environment->read()).size(), before);
  }
}

TEST_P(FlushPolls, AreForgottenWithTheirObject) {
  WriteTransaction transaction = environment->write();
  {
    const FlushPoll poll(transaction, [] { throw std::runtime_error("too late"); });
  }
  QuadWriter writer(transaction);
  change(writer, QuadReader(static_cast<const ReadTransaction&>(transaction)));
  EXPECT_NO_THROW(writer.flush());
}

INSTANTIATE_TEST_SUITE_P(Sorts, FlushPolls, testing::Values("first", "rewritten", "beside", "remove"));

}  // namespace
}  // namespace cluxel::rdf
