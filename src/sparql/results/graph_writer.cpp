// SPDX-License-Identifier: Apache-2.0
// Writes graphs as Turtle and N-Triples.
#include "cluxel/error.hpp"
#include "sparql/results/solution_writer.hpp"
#include "sparql/results/term_text.hpp"

namespace cluxel::sparql {

namespace {

constexpr std::string_view kRdfType = "http://www.w3.org/1999/02/22-rdf-syntax-ns#type";

class GraphWriter : public ResultSink {
 public:
  explicit GraphWriter(TextSink out) : buffer_(std::move(out)) {}

  void beginSolutions(std::span<const std::string>, const TermLookup&) override { refuse(); }
  void rows(std::span<const ResultId>, std::size_t) override { refuse(); }
  void boolean(bool) override { refuse(); }
  void beginGraph() override {}
  void triple(const rdf::TermView& subject, const rdf::TermView& predicate, const rdf::TermView& object) override {
    for (const rdf::TermView* term : {&subject, &predicate, &object}) {
      appendNTriples(buffer_.text(), *term);
      buffer_.text() += ' ';
    }
    buffer_.text().append(".\n");
    buffer_.flushWhenFull();
  }
  void end() override { buffer_.flush(); }

 protected:
  [[noreturn]] static void refuse() {
    throw Error(ErrorKind::InvalidArgument,
                "Turtle and N-Triples hold graphs, but the query gives rows or a boolean; "
                "choose table, json, xml, csv or tsv, or ask with CONSTRUCT");
  }

  TextBuffer buffer_;
};

/// Consecutive triples with the same subject share one subject block.
class TurtleWriter : public GraphWriter {
 public:
  TurtleWriter(TextSink out, PrefixList prefixes) : GraphWriter(std::move(out)), prefixes_(std::move(prefixes)) {}

  void beginGraph() override {
    for (const auto& [prefix, iri] : prefixes_)
      buffer_.text().append("@prefix ").append(prefix).append(": <").append(iri).append("> .\n");
  }
  void triple(const rdf::TermView& subject, const rdf::TermView& predicate, const rdf::TermView& object) override {
    const Term term = subject.toTerm();
    std::string& text = buffer_.text();
    if (open_ && term == subject_) {
      text.append(" ;\n  ");
    } else {
      if (open_) text.append(" .\n");
      appendTurtle(text += '\n', subject, prefixes_);
      text += ' ';
      subject_ = term;
    }
    open_ = true;
    if (predicate.text == kRdfType)
      text += 'a';
    else
      appendTurtle(text, predicate, prefixes_);
    appendTurtle(text += ' ', object, prefixes_);
    buffer_.flushWhenFull();
  }
  void end() override {
    if (open_) buffer_.text().append(" .\n");
    buffer_.flush();
  }

 private:
  PrefixList prefixes_;
  Term subject_;
  bool open_ = false;
};

}  // namespace

std::unique_ptr<ResultSink> makeNTriplesWriter(TextSink out) {
  return std::make_unique<GraphWriter>(std::move(out));
}

std::unique_ptr<ResultSink> makeTurtleWriter(TextSink out, const WriterOptions& options) {
  return std::make_unique<TurtleWriter>(std::move(out), options.prefixes);
}

}  // namespace cluxel::sparql
