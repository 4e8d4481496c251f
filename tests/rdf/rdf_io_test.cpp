// SPDX-License-Identifier: Apache-2.0
// Tests of the RDF readers and writers.
#include "rdf/io/rdf_io.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>
#include <thread>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "rdf/scratch_folder.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

RdfSource turtle(std::string text) {
  return {std::move(text), "test.ttl", RdfFormat::Turtle, "http://example.org/base/", Term::iri("")};
}

std::vector<Quad> parse(const RdfSource& source) {
  std::vector<Quad> quads;
  parseRdf(source, [&](const Quad& quad) { quads.push_back(quad); });
  return quads;
}

std::vector<Diagnostic> faultsOf(const RdfSource& source) {
  try {
    parse(source);
  } catch (const InputError& error) {
    return error.diagnostics();
  }
  return {};
}

/// Stores `quads` and returns the text that is written from the store.
template <typename Write>
std::string written(const std::vector<Quad>& quads, const Write& write) {
  auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  QuadWriter writer(transaction);
  for (const Quad& quad : quads) writer.add(quad);
  writer.flush();
  std::string text;
  write(QuadReader(transaction), [&](std::string_view part) { text += part; });
  return text;
}

std::string sortedNQuads(const std::vector<Quad>& quads) {
  return written(quads, [](const QuadReader& reader, const TextSink& out) { writeSortedNQuads(reader, out); });
}

TEST(RdfReader, GivesPlainLiteralsTheTypeStringAndLowersLanguageTags) {
  const std::vector<Quad> quads = parse(turtle("<a> <b> \"x\", \"y\"@EN-gb, 1, 1.5, 1e0, true ."));
  std::vector<Term> objects;
  for (const Quad& quad : quads) objects.push_back(quad.object);
  EXPECT_THAT(objects, ElementsAre(Term::literal("x"), Term::langLiteral("y", "en-gb"), Term::integer(1),
                                   Term::literal("1.5", vocabulary::xsd("decimal")),
                                   Term::literal("1e0", vocabulary::xsd("double")), Term::boolean(true)));
  EXPECT_EQ(quads.front().subject, Term::iri("http://example.org/base/a"));
}

TEST(RdfReader, KeepsBlankNodesOfSourcesApartAndOfOneSourceTheSame) {
  const std::vector<Quad> one = parse(turtle("_:x <p> _:y . _:genid1 <p> [] . [] <p> 1 ."));
  const std::vector<Quad> again = parse(turtle("_:x <p> _:y . _:genid1 <p> [] . [] <p> 1 ."));
  const std::vector<Quad> other = parse(turtle("_:x <p> _:z ."));
  EXPECT_EQ(one, again);
  EXPECT_NE(one.front().subject, other.front().subject);
  const std::set<Term> nodes = {one[0].subject, one[0].object, one[1].subject, one[1].object, one[2].subject};
  EXPECT_EQ(nodes.size(), 5U);
}

TEST(RdfReader, PutsStatementsWithoutAGraphIntoTheGivenOne) {
  RdfSource source{"<http://a> <http://b> <http://c> .\n<http://a> <http://b> <http://c> <http://g> .\n", "x.nq",
                   RdfFormat::NQuads, "", Term::iri("http://default")};
  const std::vector<Quad> quads = parse(source);
  ASSERT_EQ(quads.size(), 2U);
  EXPECT_EQ(quads[0].graph, Term::iri("http://default"));
  EXPECT_EQ(quads[1].graph, Term::iri("http://g"));
}

TEST(RdfReader, NamesFileLineAndColumnOfFaults) {
  const auto faults = faultsOf(turtle("@prefix x: <http://e/> .\nx:a x:p 1 ;\n  x:q y:z .\n"));
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(toString(faults[0].location), "test.ttl:3:7");
  EXPECT_THAT(faults[0].message, HasSubstr("prefix"));
  EXPECT_EQ(faults[0].source_line, "  x:q y:z .");
}

TEST(RdfReader, FindsTheLineOfAQuad) {
  const std::string block = "<http://e/a> <http://e/p> \"1\" ;\n  <http://e/p> \"2\" ,\n  \"3\" .\n\n# end\n";
  const auto lineOf = [](const RdfSource& source, const std::string& value) {
    const SourceLocation place = placeOf(source, [&](const Quad& quad) { return quad.object.text == value; });
    return toString(place);
  };
  const RdfSource source = turtle("# begin\n" + block + "<http://e/b> <http://e/p> \"4\" .\n");
  EXPECT_EQ(lineOf(source, "1"), "test.ttl:2");
  for (const char* value : {"2", "3"}) EXPECT_EQ(lineOf(source, value), "test.ttl:4") << "where the list ends";
  EXPECT_EQ(lineOf(source, "4"), "test.ttl:7");
  RdfSource xml{
      "<rdf:RDF xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#' xmlns:e='http://e/'>\n\n"
      "<rdf:Description rdf:about='http://e/a'>\n<e:p>1</e:p>\n<e:p>2</e:p>\n</rdf:Description>\n</rdf:RDF>",
      "x.rdf", RdfFormat::RdfXml, "", Term::iri("")};
  EXPECT_EQ(lineOf(xml, "1"), "x.rdf:4");
  EXPECT_EQ(lineOf(xml, "2"), "x.rdf:5");
  EXPECT_EQ(lineOf(source, "5"), "");
  for (const auto format : {RdfFormat::NTriples, RdfFormat::NQuads}) {
    const RdfSource lines{"# begin\n<http://e/a> <http://e/p> \"1\" .\n\n<http://e/a> <http://e/p> \"2\" .\n", "lines",
                          format, "", Term::iri("")};
    EXPECT_EQ(lineOf(lines, "1"), "lines:2");
    EXPECT_EQ(lineOf(lines, "2"), "lines:4");
  }
}

TEST(RdfReader, PassesOverAByteOrderMark) {
  EXPECT_THAT(parse(turtle("\xEF\xBB\xBF<a> <b> <c> .")), testing::SizeIs(1));
  RdfSource lines{"\xEF\xBB\xBF<http://a> <http://b> \"x\" .\n", "x.nt", RdfFormat::NTriples, "", Term::iri("")};
  EXPECT_THAT(parse(lines), testing::SizeIs(1));
}

TEST(RdfReader, DoesNotShowLinesThatNobodyCouldRead) {
  const auto faults = faultsOf(turtle("<a> <b> \"" + std::string(100'000, 'x') + "\" <c> ."));
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].location.line, 1U);
  EXPECT_LT(format(faults[0]).size(), 1000U);
}

TEST(RdfReader, ShowsAllFaultyLinesOfAnNTriplesFile) {
  RdfSource source{
      "<http://a> <http://b> \"x\" .\n<http://a> <http://b> x .\n<http://a> <http://b> \"\\q\" .\n<a> <b> "
      "<c> .\n",
      "x.nt", RdfFormat::NTriples, "", Term::iri("")};
  const auto faults = faultsOf(source);
  ASSERT_EQ(faults.size(), 3U);
  EXPECT_EQ(toString(faults[0].location), "x.nt:2:22");
  EXPECT_EQ(faults[1].message, "Illegal string escape \\q");
  EXPECT_EQ(faults[2].location.line, 4U);
}

TEST(RdfReader, RefusesBytesThatAreNotUtf8NamingThePlace) {
  const auto faults = faultsOf(turtle("<a> <b>\n  \"x\xff\" ."));
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(toString(faults[0].location), "test.ttl:2:5");
}

TEST(RdfReader, RefusesEscapesOfWhatIsNoCharacter) {
  for (const std::string escape : {"\\u0000", "\\U00000000", "\\uD800", "\\udfff", "\\U0000DC00", "\\uD83D\\uDE00"})
    for (const std::string& text : {"<a:a> <a:b>\n  \"x" + escape + "y\" .", "<a:a>\n<a:b" + escape + "> <a:c> ."}) {
      const auto faults = faultsOf(turtle(text));
      ASSERT_EQ(faults.size(), 1U) << text;
      EXPECT_EQ(faults[0].location.line, 2U) << text;
    }
  const auto quads = parse(turtle("<a:a> <a:b> \"\\\\u0000 \\\\\\u0041 \\U0001F600\" ."));
  ASSERT_EQ(quads.size(), 1U);
  EXPECT_EQ(quads[0].object.text, "\\u0000 \\A \xF0\x9F\x98\x80");
}

TEST(RdfReader, RefusesLanguageTagsThatRaptorWouldReadBeyond) {
  const auto faults = faultsOf(turtle("<a> <b>\n  \"x\"@en-" + std::string(300, 'a') + " ."));
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(toString(faults[0].location), "test.ttl:2:6");
  EXPECT_EQ(parse(turtle("<a> <b> \"x\"@en-" + std::string(250, 'a') + " .")).size(), 1U);
  const std::string xml =
      "<rdf:RDF xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#' xmlns:e='http://e/'>"
      "<rdf:Description rdf:about='http://a'><e:p xml:lang='";
  const auto rdfxml = [&](const std::string& tag) {
    return RdfSource{xml + tag + "'>x</e:p></rdf:Description></rdf:RDF>", "x.rdf", RdfFormat::RdfXml, "http://b/",
                     Term::iri("")};
  };
  EXPECT_EQ(faultsOf(rdfxml(std::string(300, 'a'))).size(), 1U);
  EXPECT_EQ(parse(rdfxml("de")).front().object, Term::langLiteral("x", "de"));
}

TEST(RdfReader, RefusesStatementsWithoutTheirFullStop) {
  const auto of = [](std::string text, RdfFormat format) {
    return RdfSource{std::move(text), "lines", format, "", Term::iri("")};
  };
  const std::string whole = "<e:a> <e:b> \"x . # \\\" y\"^^<e:#d> .\n";
  for (const char* cut : {"<e:a> <e:b> \"x\"", "<e:a> <e:b> <e:c.>", "<e:a> <e:b> \"x\"@en # .", "<e:a> <e:b> _:c"})
    for (const RdfFormat format : {RdfFormat::NTriples, RdfFormat::NQuads}) {
      const auto faults = faultsOf(of(whole + cut, format));
      ASSERT_EQ(faults.size(), 1U) << cut;
      EXPECT_EQ(faults[0].location.line, 2U);
      EXPECT_THAT(faults[0].message, HasSubstr("full stop"));
      EXPECT_FALSE(faultsOf(of(cut + ("\n" + whole), format)).empty()) << "in the middle: " << cut;
    }
  for (const char* sound : {"<e:a> <e:b> \"x\" . # c", "  # only a comment", "", "\t<e:a> <e:b> _:c.\r\n\r\n"})
    EXPECT_TRUE(faultsOf(of(whole + sound, RdfFormat::NTriples)).empty()) << sound;
}

TEST(RdfReader, ReadsOnManyThreadsAtOnce) {
  const RdfSource xml{
      "<rdf:RDF xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#'><rdf:Description rdf:about='e:a'>"
      "<p xmlns='e:'>x</p></rdf:Description></rdf:RDF>",
      "a.rdf", RdfFormat::RdfXml, "e:", Term::iri("")};
  RdfSource faulty_xml = xml;
  faulty_xml.text = "<rdf:RDF><not-closed></rdf:RDF>";
  std::vector<std::thread> threads;
  for (int number = 0; number < 8; ++number)
    threads.emplace_back([&] {
      for (int i = 0; i < 300; ++i) {
        EXPECT_EQ(parse(turtle("<a> <b> [ <c> 1 ] .")).size(), 2U);
        EXPECT_EQ(parse(xml).size(), 1U);
        EXPECT_FALSE(faultsOf(faulty_xml).empty());
        EXPECT_FALSE(faultsOf(turtle("<a> <b>")).empty());
      }
    });
  for (std::thread& thread : threads) thread.join();
}

TEST(RdfReader, PassesOnTheCallersException) {
  EXPECT_THROW(parseRdf(turtle("<a> <b> <c>, <d> ."), [](const Quad&) { throw std::domain_error("mine"); }),
               std::domain_error);
}

TEST(RdfWriter, SortsCanonicalNQuads) {
  const std::string text = sortedNQuads(parse(turtle("<b> <p> \"q\\\"\\n\\t\\u00e9\"@de . <a> <p> 1 .")));
  EXPECT_EQ(text,
            "<http://example.org/base/a> <http://example.org/base/p> "
            "\"1\"^^<http://www.w3.org/2001/XMLSchema#integer> .\n"
            "<http://example.org/base/b> <http://example.org/base/p> \"q\\\"\\n\té\"@de .\n");
}

Term randomTerm(std::mt19937& random, bool literal) {
  static const std::vector<std::string> texts = {
      "a",   "http://x/y",   "",         "1",  "01",   "1.0",     "1.",  "INF", "true",
      "1e3", "é\"\\\n\r\t'", "\x01\x7f", "+5", "-0.5", "abc def", "a.b", "😀"};
  static const std::vector<std::string> types = {"integer", "decimal", "double", "boolean", "date", "string"};
  const std::string& text = texts[random() % texts.size()];
  switch (random() % (literal ? 4 : 2)) {
    case 0:
      return Term::iri("http://example.org/" + std::to_string(random() % 9) + (random() % 2 == 0 ? "é/%20,b" : ""));
    case 1:
      return Term::blank("n" + std::to_string(random() % 5));
    case 2:
      return Term::langLiteral(text, random() % 2 == 0 ? "en" : "de-AT");
    default:
      return Term::literal(text, vocabulary::xsd(types[random() % types.size()]));
  }
}

/// Renames blank nodes in the order in which they occur in the sorted lines. This is no canonical form in general, but
/// sufficient for these few quads.
std::multiset<std::string> shapes(const std::vector<Quad>& quads) {
  std::multiset<std::string> lines;
  for (Quad quad : quads) {
    for (Term* term : {&quad.subject, &quad.object})
      if (term->kind == TermKind::BlankNode) term->text = "x";
    lines.insert(toNQuads(quad));
  }
  return lines;
}

TEST(RdfWriter, WritesTextsThatReadBackAsTheSameQuads) {
  std::mt19937 random(7);
  std::set<Quad> quads;
  for (int i = 0; i < 600; ++i)
    quads.insert({randomTerm(random, false), Term::iri(vocabulary::clx("p" + std::to_string(random() % 4))),
                  randomTerm(random, true), Term::iri("")});
  const std::vector<Quad> list(quads.begin(), quads.end());
  const RdfSource nquads{sortedNQuads(list), "x.nq", RdfFormat::NQuads, "", Term::iri("")};
  EXPECT_EQ(shapes(parse(nquads)), shapes(list));
  const std::string text =
      written(list, [](const QuadReader& reader, const TextSink& out) { writeTurtle(reader, Term::iri(""), out); });
  EXPECT_EQ(shapes(parse(turtle(text))), shapes(list));
}

TEST(RdfWriter, WritesReadableTurtle) {
  const std::string text =
      written(parse(turtle("@prefix clx: <https://w3id.org/cluxel/ontology#> . clx:Tree clx:height 2.5, 3 ; "
                           "a clx:Thing ; clx:p clx:q .")),
              [](const QuadReader& reader, const TextSink& out) {
                writeTurtle(reader, std::nullopt, out, {{"clx", std::string(vocabulary::kClx)}});
              });
  EXPECT_EQ(text,
            "@prefix clx: <https://w3id.org/cluxel/ontology#> .\n\n"
            "clx:Tree a clx:Thing ;\n    clx:height 2.5, 3 ;\n    clx:p clx:q .\n");
}

/// The statements of a source, and its faults after them.
std::vector<std::string> statementsOf(const RdfSource& source) {
  std::vector<std::string> all;
  try {
    parseRdf(source, [&](const Quad& quad) { all.push_back(toNQuads(quad)); });
  } catch (const Error& error) {
    all.emplace_back(error.what());
  }
  return all;
}

/// Texts of several pieces with statements, strings and comments across their borders, and faults in late lines.
TEST(RdfPieces, OfAFileGiveWhatTheTextGives) {
  const ScratchFolder folder;
  const std::string long_text(300'000, 'x');
  std::string text_of_turtle = "\xEF\xBB\xBF@prefix e: <http://e/> .\n", lines = "\xEF\xBB\xBF";
  for (int i = 0; i < 9'000; ++i) {
    const std::string n = std::to_string(i);
    text_of_turtle +=
        "# it's \"" + n + "\ne:s" + n + " e:p \"\"\"a . b\n\n# " + n + "\"\"\" , _:b" + n + " ;\n e:q ( 1 _:b3 ) .\n";
    lines += "<http://e/s" + n + "> <http://e/p> _:b" + std::to_string(i % 7) + " .\n";
  }
  lines += "<http://e/long> <http://e/p> \"" + long_text + "\" .\n";
  const std::string late_fault = lines + "<http://e/a> <http://e/b> .\n<http://e/a> <http://e/b> _:b1 .\n";
  const std::string bad_bytes = lines + "<http://e/a> <http://e/b> \"\xFF\" .\n";
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"a.ttl", text_of_turtle},
                                   {"b.trig", text_of_turtle},
                                   {"c.nt", lines},
                                   {"d.nq", lines},
                                   {"e.nt", late_fault},
                                   {"f.nq", bad_bytes},
                                   {"g.ttl", text_of_turtle + "e:a e:b .\n"},
                                   {"h.nt", ""}}) {
    const std::filesystem::path file = folder.path() / name;
    writeFile(file, text);
    const RdfSource in_memory = readRdfSource(file);
    const std::vector<std::string> from_file = statementsOf(openRdfSource(file)), from_text = statementsOf(in_memory);
    if (name < "e") {
      EXPECT_EQ(from_file, from_text) << name;
    } else if (!text.empty()) {
      EXPECT_EQ(from_file.back(), from_text.back()) << name << ": the message, after the statements read so far";
    }
  }
  EXPECT_THAT(statementsOf(openRdfSource(folder.path() / "e.nt")).back(), testing::HasSubstr("e.nt:9002"));
  EXPECT_THAT(statementsOf(openRdfSource(folder.path() / "f.nq")).back(), testing::HasSubstr("f.nq:9002"));
  EXPECT_EQ(statementsOf(openRdfSource(folder.path() / "a.ttl")).size(), 9'000U * 7);
}

/// libxml2 refuses to look ahead over more than 10 MB.
TEST(RdfPieces, LetLongXmlBeRead) {
  std::string xml = "<rdf:RDF xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#' xmlns:e='http://e/'>\n";
  for (int i = 0; i < 150'000; ++i)
    xml += "<rdf:Description rdf:about='http://e/s" + std::to_string(i) + "'><e:p>" + std::to_string(i) +
           "</e:p></rdf:Description>\n";
  const auto all = statementsOf({xml + "</rdf:RDF>\n", "x.rdf", RdfFormat::RdfXml, "http://b/", Term::iri("")});
  EXPECT_EQ(all.size(), 150'000U) << all.back();
}

}  // namespace
}  // namespace cluxel::rdf
