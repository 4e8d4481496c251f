// SPDX-License-Identifier: Apache-2.0
// Writes an aligned text table. The first rows are kept back, because column widths depend on their cells; later cells
// that are wider move the rest of their row.
#include <algorithm>

#include "base/utf8.hpp"
#include "sparql/results/solution_writer.hpp"
#include "sparql/results/term_text.hpp"

namespace cluxel::sparql {

namespace {

class TableWriter : public ResultSink {
 public:
  TableWriter(TextSink out, PrefixList prefixes) : buffer_(std::move(out)), prefixes_(std::move(prefixes)) {}

  void beginSolutions(std::span<const std::string> variables, const TermLookup& terms) override {
    terms_ = &terms;
    begin({variables.begin(), variables.end()});
  }
  void rows(std::span<const ResultId> cells, std::size_t count) override {
    row_count_ += count;
    for (const ResultId id : cells) {
      if (id == 0)
        addCell({}, false);
      else
        add(terms_->view(id));
    }
  }
  void boolean(bool value) override {
    buffer_.text().append(value ? "yes\n" : "no\n");
    buffer_.flush();
  }
  void beginGraph() override { begin({"subject", "predicate", "object"}); }
  void triple(const rdf::TermView& subject, const rdf::TermView& predicate, const rdf::TermView& object) override {
    ++row_count_;
    for (const rdf::TermView* term : {&subject, &predicate, &object}) add(*term);
  }
  void end() override;

 private:
  void begin(std::vector<std::string> variables) {
    variables_ = std::move(variables);
    is_tabular_ = true;
    for (const std::string& name : variables_) widths_.push_back(countCodePoints(name));
  }
  void add(const rdf::TermView& term) {
    std::string text;
    appendPlain(text, term, prefixes_);
    const bool number = term.kind == TermKind::Literal && !text.empty() &&
                        text.find_first_not_of("+-.0123456789eE") == std::string::npos;
    addCell(std::move(text), number);
  }
  void addCell(std::string text, bool number) {
    if (is_header_written_) return writeNext({std::move(text), number});
    std::size_t& width = widths_[cells_.size() % variables_.size()];
    width = std::max(width, countCodePoints(text));
    kept_bytes_ += sizeof(Cell) + text.size();
    cells_.push_back({std::move(text), number});
    if (kept_bytes_ > kMaxKeptBytes) writeKept();
  }
  void writeCell(std::size_t column, std::string_view text, bool right) {
    const std::size_t shown = countCodePoints(text);
    const std::string padding(widths_[column] - std::min(widths_[column], shown), ' ');
    const bool last = column + 1 == variables_.size();
    buffer_.text().append(column > 0 ? "  " : "").append(right ? padding : "").append(text);
    if (!right && !last) buffer_.text().append(padding);
  }
  void writeHeader();
  void writeKept();

  struct Cell {
    std::string text;
    bool number;
  };
  void writeNext(const Cell& cell) {
    writeCell(next_column_, cell.text, cell.number);
    next_column_ = (next_column_ + 1) % variables_.size();
    if (next_column_ == 0) buffer_.text() += '\n';
    buffer_.flushWhenFull();
  }

  static constexpr std::size_t kMaxKeptBytes = std::size_t{8} << 20U;
  TextBuffer buffer_;
  PrefixList prefixes_;
  const TermLookup* terms_ = nullptr;
  std::vector<std::string> variables_;
  std::vector<std::size_t> widths_;
  std::vector<Cell> cells_;
  std::size_t row_count_ = 0, kept_bytes_ = 0, next_column_ = 0;
  bool is_tabular_ = false, is_header_written_ = false;
};

void TableWriter::writeHeader() {
  for (std::size_t i = 0; i < variables_.size(); ++i) writeCell(i, variables_[i], false);
  buffer_.text() += '\n';
  for (std::size_t i = 0; i < variables_.size(); ++i) writeCell(i, std::string(widths_[i], '-'), false);
  buffer_.text() += '\n';
}

void TableWriter::writeKept() {
  writeHeader();
  is_header_written_ = true;
  for (const Cell& cell : cells_) writeNext(cell);
  cells_ = {};
}

void TableWriter::end() {
  if (is_tabular_) {
    if (!is_header_written_) writeKept();
    buffer_.text().append(std::to_string(row_count_)).append(row_count_ == 1 ? " row\n" : " rows\n");
  }
  buffer_.flush();
}

}  // namespace

std::unique_ptr<ResultSink> makeTableWriter(TextSink out, const WriterOptions& options) {
  return std::make_unique<TableWriter>(std::move(out), options.prefixes);
}

}  // namespace cluxel::sparql
