// SPDX-License-Identifier: Apache-2.0
// CSV and TSV results (SPARQL 1.1 Query Results CSV and TSV Formats). The result of ASK is one line, true or false.
#include "sparql/results/solution_writer.hpp"
#include "sparql/results/term_text.hpp"

namespace cluxel::sparql {

namespace {

class SeparatedWriter : public SolutionWriter {
 public:
  SeparatedWriter(TextSink out, AppendTerm append_term, char separator, std::string_view variable_mark,
                  std::string_view line_end)
      : SolutionWriter(std::move(out), append_term),
        separator_(separator),
        variable_mark_(variable_mark),
        line_end_(line_end) {}

  void boolean(bool value) override {
    buffer_.text().append(value ? "true" : "false").append(line_end_);
    buffer_.flush();
  }

 protected:
  void header() override {
    for (std::size_t i = 0; i < variables_.size(); ++i) {
      if (i > 0) buffer_.text() += separator_;
      buffer_.text().append(variable_mark_).append(variables_[i]);
    }
    buffer_.text().append(line_end_);
  }
  void beginRow() override {}
  void beginCell(std::size_t column, bool) override {
    if (column > 0) buffer_.text() += separator_;
  }
  void endRow() override { buffer_.text().append(line_end_); }

 private:
  char separator_;
  std::string_view variable_mark_, line_end_;
};

}  // namespace

std::unique_ptr<ResultSink> makeCsvWriter(TextSink out) {
  return std::make_unique<SeparatedWriter>(std::move(out), &appendCsv, ',', "", "\r\n");
}

std::unique_ptr<ResultSink> makeTsvWriter(TextSink out) {
  const auto append = static_cast<SolutionWriter::AppendTerm>(&appendTurtle);
  return std::make_unique<SeparatedWriter>(std::move(out), append, '\t', "?", "\n");
}

}  // namespace cluxel::sparql
