// SPDX-License-Identifier: Apache-2.0
// Opens what a command line names.
#include "app/named_sources.hpp"

#include "cluxel/error.hpp"

namespace cluxel::app {

tasks::Question questionFrom(const fs::path& file, const std::string& text, const Session& session) {
  if (!text.empty() && !file.empty()) throw Error(ErrorKind::InvalidArgument, "give a query file or -e TEXT, not both");
  if (file.empty() && text.empty())
    throw Error(ErrorKind::InvalidArgument, "give a query file, or a query with -e TEXT");
  if (!file.empty()) {
    fs::path name = file;
    std::error_code ignored;
    const bool is_file = fs::exists(name, ignored) && !fs::is_directory(name, ignored);  // a pipe too
    if (!name.has_extension() && !is_file) name += ".rq";
    return tasks::readQuestion(session.dataHome().locate("queries", name));
  }
  tasks::Question question;
  question.file = "-e";
  question.text = text;
  return question;
}

std::map<std::string, fs::path> namedFiles(const std::string& option, const std::vector<std::string>& texts) {
  std::map<std::string, fs::path> files;
  for (const std::string& text : texts) {
    // The last '=': IRIs may contain it in their query part, file names seldom do.
    const std::size_t cut = text.rfind('=');
    if (cut == std::string::npos || cut == 0 || cut + 1 == text.size())
      throw Error(ErrorKind::InvalidArgument, option + " " + text + ": write IRI=FILE");
    files[text.substr(0, cut)] = text.substr(cut + 1);
  }
  return files;
}

NamedSources::NamedSources(const std::string& option, const std::vector<std::string>& texts) {
  for (const auto& [iri, file] : namedFiles(option, texts)) {
    sources_.push_back(tasks::openQuerySource(file));
    readers_.emplace(iri, sources_.back().reader());
  }
}

std::map<std::string, const rdf::QuadReader*> NamedSources::readers() const {
  std::map<std::string, const rdf::QuadReader*> readers;
  for (const auto& [iri, reader] : readers_) readers.emplace(iri, &reader);
  return readers;
}

}  // namespace cluxel::app
