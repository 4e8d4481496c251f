// SPDX-License-Identifier: Apache-2.0
// SPARQL 1.1 Query Results JSON Format, one row per line.
#include "sparql/results/solution_writer.hpp"
#include "sparql/results/term_text.hpp"

namespace cluxel::sparql {

namespace {

class JsonWriter : public SolutionWriter {
 public:
  explicit JsonWriter(TextSink out) : SolutionWriter(std::move(out), &appendJson) {}

  void boolean(bool value) override {
    buffer_.text().append("{\"head\":{},\"boolean\":").append(value ? "true" : "false").append("}\n");
    buffer_.flush();
  }

 protected:
  void header() override {
    std::string& text = buffer_.text();
    text.append("{\"head\":{\"vars\":[");
    for (const std::string& name : variables_) {
      if (!keys_.empty()) text += ',';
      std::string key;
      appendJsonString(key, name);
      text.append(key);
      keys_.push_back(key + ':');
    }
    text.append("]},\"results\":{\"bindings\":[");
  }
  void beginRow() override {
    buffer_.text().append(first_row_ ? "\n{" : ",\n{");
    first_row_ = false;
    first_cell_ = true;
  }
  void beginCell(std::size_t column, bool bound) override {
    if (!bound) return;
    if (!first_cell_) buffer_.text() += ',';
    first_cell_ = false;
    buffer_.text().append(keys_[column]);
  }
  void endRow() override { buffer_.text() += '}'; }
  void footer() override {
    if (solutions_) buffer_.text().append("\n]}}\n");
  }

 private:
  std::vector<std::string> keys_;
  bool first_row_ = true, first_cell_ = true;
};

}  // namespace

std::unique_ptr<ResultSink> makeJsonWriter(TextSink out) {
  return std::make_unique<JsonWriter>(std::move(out));
}

}  // namespace cluxel::sparql
