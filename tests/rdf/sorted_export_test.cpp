// SPDX-License-Identifier: Apache-2.0
// Sorted exports of random stores, against all quads sorted in memory, with limits that make every subject and every
// quad a run of its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>

#include "rdf/io/canonical_labels.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/io/turtle_writer.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {
namespace {

constexpr std::array<std::size_t, 4> kLimits{1, 100, 3000, SortedRecords::kUsualBytes};

Term randomNode(std::mt19937& random) {
  static const std::vector<std::string> ends = {"", "a", "ab", "a b", "a>", "a!", "é", "#", "a/b", "\x7f", "A"};
  if (random() % 3 == 0) return Term::blank("n" + std::to_string(random() % 12));
  return Term::iri("http://x/" + ends[random() % ends.size()]);
}

Term randomObject(std::mt19937& random) {
  using namespace std::string_literals;
  static const std::vector<std::string> texts = {"", "\0"s, "\0a"s, "a\0"s, "\x01", "a", "a\"", "a\n", "1", "1.0", "é"};
  static const std::vector<std::string> types = {"string", "integer", "decimal", "date"};
  const std::string& text = texts[random() % texts.size()];
  switch (random() % 4) {
    case 0:
      return Term::langLiteral(text, random() % 2 == 0 ? "en" : "en-gb");
    case 1:
      return Term::literal(text, vocabulary::xsd(types[random() % types.size()]));
    default:
      return randomNode(random);
  }
}

std::vector<Quad> randomQuads(std::mt19937& random, std::size_t count) {
  static const std::vector<Term> predicates = {Term::iri(vocabulary::rdf("type")), Term::iri("http://x/p"),
                                               Term::iri("http://x/pq"), Term::iri("http://a/z")};
  const std::vector<Term> graphs = {Term::iri(""), Term::iri("http://x/g"), Term::iri(vocabulary::kGraphHistory),
                                    Term::blank("n3")};
  std::set<Quad> quads;
  for (std::size_t i = 0; i < count; ++i)
    quads.insert({randomNode(random), predicates[random() % predicates.size()], randomObject(random),
                  graphs[random() % graphs.size()]});
  std::vector<Quad> list(quads.begin(), quads.end());
  std::shuffle(list.begin(), list.end(), random);
  return list;
}

bool isNoHistory(const Term& graph) {
  return graph.text != vocabulary::kGraphHistory;
}

bool namesBlankNode(const Quad& quad) {
  return quad.subject.kind == TermKind::BlankNode || quad.object.kind == TermKind::BlankNode ||
         quad.graph.kind == TermKind::BlankNode;
}

std::string sortedLines(std::vector<Quad> quads, const std::map<std::string, std::string>& labels) {
  std::set<std::string> lines;
  for (Quad& quad : quads) {
    for (Term* term : {&quad.subject, &quad.object, &quad.graph})
      if (term->kind == TermKind::BlankNode && !labels.empty()) term->text = labels.at(term->text);
    lines.insert(toNQuads(quad));
  }
  std::string text;
  for (const std::string& line : lines) text += line;
  return text;
}

struct WrittenOnce {
  Term subject;
  bool is_no_type = false;
  Term predicate, object;
  auto operator<=>(const WrittenOnce&) const = default;
};

std::string turtleOf(const std::vector<Quad>& quads) {
  std::set<WrittenOnce> triples;
  for (const Quad& quad : quads)
    triples.insert({quad.subject, quad.predicate.text != vocabulary::rdf("type"), quad.predicate, quad.object});
  const TurtleTerms terms(commonPrefixes());
  std::string text = terms.header();
  const WrittenOnce* last = nullptr;
  for (const WrittenOnce& triple : triples) {
    const bool same_subject = last != nullptr && triple.subject == last->subject;
    const bool same_predicate = same_subject && triple.predicate == last->predicate;
    if (!same_subject) text += (last != nullptr ? " .\n\n" : "\n") + terms.text(triple.subject) + ' ';
    if (same_subject) text += same_predicate ? ", " : " ;\n    ";
    if (!same_predicate) text += (triple.is_no_type ? terms.text(triple.predicate) : "a") + ' ';
    text += terms.text(triple.object);
    last = &triple;
  }
  return last == nullptr ? text : text + " .\n";
}

class SortedExport : public testing::Test {
 protected:
  /// Stores random quads, of which `quads_` holds all and `kept_` those outside of history.
  void store(std::size_t count) {
    quads_ = randomQuads(random_, count);
    kept_.clear();
    std::copy_if(quads_.begin(), quads_.end(), std::back_inserter(kept_),
                 [](const Quad& quad) { return isNoHistory(quad.graph); });
    environment_ = Environment::temporary();
    WriteTransaction transaction = environment_->write();
    QuadWriter writer(transaction);
    for (const Quad& quad : quads_) writer.add(quad);
    writer.flush();
    transaction.commit();
  }

  template <typename Write>
  std::string written(const Write& write) {
    std::string text;
    write(QuadReader(environment_->read()), [&](std::string_view piece) { text += piece; });
    return text;
  }

  std::mt19937 random_{11};
  std::vector<Quad> quads_, kept_;
  std::shared_ptr<Environment> environment_;
};

TEST_F(SortedExport, OfNQuadsHasTheLinesInOrderWhateverFitsIntoMemory) {
  for (int round = 0; round < 30; ++round) {
    store(random_() % 400);
    for (const std::size_t limit : kLimits)
      ASSERT_EQ(
          written([&](const QuadReader& reader, const TextSink& out) { writeSortedNQuads(reader, out, {}, limit); }),
          sortedLines(quads_, {}))
          << round << ", limit " << limit;
  }
}

TEST_F(SortedExport, OfCanonicalNQuadsHasTheLinesInOrderWhateverFitsIntoMemory) {
  int with_labels = 0;
  for (int round = 0; round < 30; ++round) {
    store(random_() % 200);
    std::vector<Quad> with_blanks;
    std::copy_if(kept_.begin(), kept_.end(), std::back_inserter(with_blanks), namesBlankNode);
    const auto labels = canonicalLabels(with_blanks);
    with_labels += labels.empty() ? 0 : 1;
    for (const std::size_t limit : kLimits) {
      bool is_exact = false;
      ASSERT_EQ(written([&](const QuadReader& reader, const TextSink& out) {
                  is_exact = writeCanonicalNQuads(reader, out, isNoHistory, limit);
                }),
                sortedLines(kept_, labels))
          << round << ", limit " << limit;
      EXPECT_EQ(is_exact, !labels.empty() || with_blanks.empty());
    }
  }
  EXPECT_GT(with_labels, 20);
}

TEST_F(SortedExport, OfTurtleHasTheTriplesInOrderWhateverFitsIntoMemory) {
  for (int round = 0; round < 30; ++round) {
    store(random_() % 400);
    std::vector<Quad> in_graph;
    std::copy_if(quads_.begin(), quads_.end(), std::back_inserter(in_graph),
                 [](const Quad& quad) { return quad.graph.text == "http://x/g"; });
    for (const std::size_t limit : kLimits) {
      ASSERT_EQ(written([&](const QuadReader& reader, const TextSink& out) {
                  writeTurtle(reader, std::nullopt, out, commonPrefixes(), limit);
                }),
                turtleOf(kept_))
          << round << ", limit " << limit;
      ASSERT_EQ(written([&](const QuadReader& reader, const TextSink& out) {
                  writeTurtle(reader, Term::iri("http://x/g"), out, commonPrefixes(), limit);
                }),
                turtleOf(in_graph))
          << round << ", limit " << limit;
    }
  }
}

}  // namespace
}  // namespace cluxel::rdf
