// SPDX-License-Identifier: Apache-2.0
// Headers of questions, their parameters, and the sources of queries.
#include "tasks/query_source.hpp"

#include <gtest/gtest.h>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "rdf/scratch_folder.hpp"
#include "test_paths.hpp"

namespace cluxel::tasks {

using namespace rdf;
using namespace sparql;
namespace {

class Questions : public testing::Test {
 protected:
  Question read(const std::string& text) const {
    writeFile(folder.path() / "question.rq", text);
    return readQuestion(folder.path() / "question.rq");
  }
  std::string fault(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no fault";
  }
  ScratchFolder folder;
};

TEST_F(Questions, AHeaderTellsTitleColumnsAndParameters) {
  const Question question = read(
      "#! title: What is near?\n#! column: thing [iri] the thing\n#! column: far [m] how far\n"
      "#! parameter: within [m] = 5 the largest distance\nSELECT ?thing ?far WHERE { }\n");
  EXPECT_EQ(question.title, "What is near?");
  ASSERT_EQ(question.columns.size(), 2U);
  EXPECT_EQ(question.columns[1].name, "far");
  EXPECT_EQ(question.columns[1].unit, "m");
  EXPECT_EQ(question.columns[1].help, "how far");
  ASSERT_EQ(question.parameters.size(), 1U);
  EXPECT_EQ(question.parameters[0].name, "within");
  EXPECT_EQ(question.parameters[0].default_value, "5");
}

TEST_F(Questions, AHeaderLineMayStandWithoutABlank) {
  const Question question = read("#!title: What is near?\n#!\tcolumn: thing [iri] the thing\n#!\nASK { }\n");
  EXPECT_EQ(question.title, "What is near?");
  ASSERT_EQ(question.columns.size(), 1U);
  EXPECT_EQ(question.columns[0].help, "the thing");
}

TEST_F(Questions, AHeaderMayHaveLongLinesAndLineEndsOfWindows) {
  const std::string help(500'000, 'x');
  const Question question = read("#! title: What is near?\r\n#! column: thing [iri] " + help +
                                 "\r\n#! parameter: within [m] = 5\r\nASK { }\r\n");
  EXPECT_EQ(question.title, "What is near?");
  ASSERT_EQ(question.columns.size(), 1U);
  EXPECT_EQ(question.columns[0].help, help);
  ASSERT_EQ(question.parameters.size(), 1U);
  EXPECT_EQ(question.parameters[0].default_value, "5");
  EXPECT_LT(fault("#! " + help + "\nASK { }\n").size(), 1000U);
}

TEST_F(Questions, AFileWithoutHeaderIsAQuestionWithoutTitle) {
  const Question question = read("# a comment\nASK { }\n");
  EXPECT_EQ(question.title, "");
  EXPECT_TRUE(question.columns.empty());
}

TEST_F(Questions, ABrokenHeaderLineIsNamedWithFileAndLine) {
  EXPECT_NE(fault("#! title: x\n#! colum: a [m] b\n").find("question.rq:2"), std::string::npos);
  EXPECT_NE(fault("#! column: a b c\n").find("question.rq:1"), std::string::npos);
  EXPECT_NE(fault("#! parameter: a [m] 5\n").find("question.rq:1"), std::string::npos);
  EXPECT_NE(fault("SELECT *\n#! title:\nWHERE {}").find("question.rq:2"), std::string::npos) << "an empty title";
}

TEST_F(Questions, ParametersTakeTheGivenValueOrTheDefault) {
  const Question question = read("#! parameter: a [m] = 5 x\n#! parameter: c [class] = clx:Tree y\nASK { }\n");
  const auto defaults = bindingsFor(question, {});
  ASSERT_EQ(defaults.size(), 2U);
  EXPECT_EQ(defaults[0].second.text, "5");
  EXPECT_EQ(defaults[1].second, Term::iri("https://w3id.org/cluxel/ontology#Tree"));
  const auto given = bindingsFor(question, {"a=2.5", "c=<https://example.org/x>"});
  EXPECT_EQ(given[0].second, Term::literal("2.5", "http://www.w3.org/2001/XMLSchema#decimal"));
  EXPECT_EQ(given[1].second, Term::iri("https://example.org/x"));
}

TEST_F(Questions, ANumberIsExpectedWhereTheDefaultIsOne) {
  const Question question = read("#! parameter: far [m] = 5 x\n#! parameter: name [text] = oak y\nASK { }\n");
  EXPECT_EQ(bindingsFor(question, {"name=hello"})[1].second, Term::literal("hello"));
  EXPECT_EQ(bindingsFor(question, {"far=-1e3"})[0].second,
            Term::literal("-1e3", "http://www.w3.org/2001/XMLSchema#double"));
  for (const char* text : {"far=away", "far=inf", "far=nan", "far=1,5", "far=", "far=2 m"}) {
    try {
      bindingsFor(question, {text});
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
      EXPECT_NE(std::string(error.what()).find("a number is expected [m]"), std::string::npos) << error.what();
    }
  }
}

TEST_F(Questions, AParameterMayHaveARange) {
  const Question question = read(
      "#! parameter: far [m] = 5 (from 0) how far\n#! parameter: share [1] = 0.5 (from -1 to 1)\n"
      "#! parameter: free [m] = 1 (as the crow flies)\nASK { }\n");
  ASSERT_EQ(question.parameters.size(), 3U);
  EXPECT_EQ(question.parameters[0].help, "how far");
  EXPECT_EQ(question.parameters[1].help, "");
  EXPECT_EQ(question.parameters[2].help, "(as the crow flies)");
  bindingsFor(question, {"far=0", "share=-1", "free=-1e9"});
  bindingsFor(question, {"far=1e9", "share=1"});
  const auto refusal = [&](const char* given) {
    try {
      bindingsFor(question, {given});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("nothing was refused");
  };
  EXPECT_NE(refusal("far=-3").find("far=-3: a number from 0 is expected [m]"), std::string::npos) << refusal("far=-3");
  EXPECT_NE(refusal("share=1.1").find("a number from -1 to 1 is expected [1]"), std::string::npos);
  for (const char* range : {"(from )", "(from a)", "(from 0 to)", "(from 0 1)", "(from 0 to 1", "(from 0 to b)"})
    EXPECT_NE(fault("#! parameter: far [m] = 5 " + std::string(range) + " x\n").find("question.rq:1"),
              std::string::npos)
        << range;
}

TEST_F(Questions, AnUnknownParameterIsAnErrorOfUsage) {
  const Question question = read("#! parameter: within [m] = 5 x\nASK { }\n");
  for (const char* text : {"wihtin=3", "within", "=3"}) {
    try {
      bindingsFor(question, {text});
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos);
    }
  }
}

TEST_F(Questions, ATurtleFileIsAskedLikeAMap) {
  writeFile(folder.path() / "x.ttl", "<https://e.org/a> <https://e.org/p> 1, 2 .\n");
  const QuerySource source = openQuerySource(folder.path() / "x.ttl");
  const QuadReader reader = source.reader();
  EXPECT_EQ(
      evaluateQuery(reader, "SELECT ?o WHERE { ?s ?p ?o }", {.default_graph = source.default_graph}).table.row_count,
      2U);
  EXPECT_THROW(openQuerySource(folder.path() / "absent.ttl"), Error);
}

TEST(ShippedQuestions, HaveATitleAndExactlyTheColumnsThatTheySelect) {
  const auto questions = shippedQuestions(DataHome(test::sourceFolder()));
  ASSERT_GE(questions.size(), 5U);
  const auto environment = Environment::temporary();
  const QuadReader reader(environment->read());
  for (const Question& question : questions) {
    EXPECT_NE(question.title, "") << question.file;
    std::vector<std::string> parameters, columns;
    for (const Binding& binding : bindingsFor(question, {})) parameters.push_back(binding.first);
    for (const QueryColumn& column : question.columns) {
      columns.push_back(column.name);
      EXPECT_NE(column.unit, "") << question.file << " " << column.name;
      EXPECT_NE(column.help, "") << question.file << " " << column.name;
    }
    PreparedQuery query(reader, question.text, {}, parameters);
    EXPECT_EQ(query.variables(), columns) << question.file;
    EXPECT_NO_THROW(query.evaluate(bindingsFor(question, {}))) << question.file;
  }
}

TEST(QuerySources, ABuildThatHasCommittedNothingAnswersNothing) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "map.clx";
  Environment::open(file, OpenMode::Create);
  EXPECT_EQ(openQuerySource(file).reader().size(), 0U) << "a store";
  writeFile(folder.path() / "map.clx.build-lock", "");  // which a killed build leaves, too
  EXPECT_THROW(openQuerySource(file), Error);
  {
    WriteTransaction transaction = Environment::open(file, OpenMode::ReadWrite)->write();
    QuadWriter writer(transaction);
    writer.add({Term::iri("http://x/a"), Term::iri("http://x/p"), Term::literal("1"), Term::iri("")});
    writer.flush();
    transaction.commit();
  }
  EXPECT_EQ(openQuerySource(file).reader().size(), 1U);
}

}  // namespace
}  // namespace cluxel::tasks
