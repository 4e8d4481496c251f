// SPDX-License-Identifier: Apache-2.0
// SPARQL Query Results XML Format.
#include "sparql/results/solution_writer.hpp"
#include "sparql/results/term_text.hpp"

namespace cluxel::sparql {

namespace {

constexpr std::string_view kOpening =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<sparql xmlns=\"http://www.w3.org/2005/sparql-results#\">\n";

class XmlWriter : public SolutionWriter {
 public:
  explicit XmlWriter(TextSink out) : SolutionWriter(std::move(out), &appendXml) {}

  void boolean(bool value) override {
    buffer_.text().append(kOpening).append("<head/>\n<boolean>").append(value ? "true" : "false");
    buffer_.text().append("</boolean>\n</sparql>\n");
    buffer_.flush();
  }

 protected:
  void header() override {
    buffer_.text().append(kOpening).append("<head>");
    for (const std::string& name : variables_) {
      std::string quoted;
      appendXmlText(quoted, name);
      buffer_.text().append("<variable name=\"").append(quoted).append("\"/>");
      openings_.push_back("<binding name=\"" + quoted + "\">");
    }
    buffer_.text().append("</head>\n<results>\n");
  }
  void beginRow() override { buffer_.text().append("<result>"); }
  void beginCell(std::size_t column, bool bound) override {
    if (bound) buffer_.text().append(openings_[column]);
  }
  void endCell() override { buffer_.text().append("</binding>"); }
  void endRow() override { buffer_.text().append("</result>\n"); }
  void footer() override {
    if (solutions_) buffer_.text().append("</results>\n</sparql>\n");
  }

 private:
  std::vector<std::string> openings_;
};

}  // namespace

std::unique_ptr<ResultSink> makeXmlWriter(TextSink out) {
  return std::make_unique<XmlWriter>(std::move(out));
}

}  // namespace cluxel::sparql
