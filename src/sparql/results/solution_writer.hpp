// SPDX-License-Identifier: Apache-2.0
// Base of the result writers: a buffered output and a cache of the texts of recent terms.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sparql/results/result_writer.hpp"

namespace cluxel::sparql {

/// Buffers text and passes it on in chunks.
class TextBuffer {
 public:
  explicit TextBuffer(TextSink out) : out_(std::move(out)) { text_.reserve(kPiece + kPiece / 4); }
  std::string& text() { return text_; }
  void flushWhenFull() {
    if (text_.size() >= kPiece) flush();
  }
  void flush() {
    if (!text_.empty()) out_(text_);
    text_.clear();
  }

 private:
  static constexpr std::size_t kPiece = 1 << 16;
  TextSink out_;
  std::string text_;
};

/// A writer that formats cells independently of their row and caches the text of terms, because results repeat them.
/// Writes a graph as a table of subject, predicate and object.
class SolutionWriter : public ResultSink {
 public:
  using AppendTerm = void (*)(std::string& text, const rdf::TermView& term);
  SolutionWriter(TextSink out, AppendTerm append_term);

  void beginSolutions(std::span<const std::string> variables, const TermLookup& terms) override;
  void rows(std::span<const ResultId> cells, std::size_t count) override;
  void beginGraph() override;
  void triple(const rdf::TermView& subject, const rdf::TermView& predicate, const rdf::TermView& object) override;
  void end() override;

 protected:
  virtual void header() = 0;
  /// Writes the separator before a cell; appendCell() follows if `bound`.
  virtual void beginRow() = 0;
  virtual void beginCell(std::size_t column, bool bound) = 0;
  virtual void endCell() {}
  virtual void endRow() = 0;
  virtual void footer() {}

  TextBuffer buffer_;
  std::vector<std::string> variables_;
  bool solutions_ = false;

 private:
  void appendCell(ResultId id);

  /// Direct-mapped by the low bits of the id.
  struct Cached {
    ResultId id = 0;
    std::string text;
  };
  static constexpr std::size_t kCached = 4096;

  AppendTerm append_term_;
  const TermLookup* terms_ = nullptr;
  std::vector<Cached> cache_;
};

std::unique_ptr<ResultSink> makeJsonWriter(TextSink out);
std::unique_ptr<ResultSink> makeXmlWriter(TextSink out);
std::unique_ptr<ResultSink> makeCsvWriter(TextSink out);
std::unique_ptr<ResultSink> makeTsvWriter(TextSink out);
std::unique_ptr<ResultSink> makeTableWriter(TextSink out, const WriterOptions& options);
std::unique_ptr<ResultSink> makeNTriplesWriter(TextSink out);
std::unique_ptr<ResultSink> makeTurtleWriter(TextSink out, const WriterOptions& options);

/// The prefixes of Cluxel's vocabulary.
std::vector<std::pair<std::string, std::string>> vocabularyPrefixes();

}  // namespace cluxel::sparql
