// SPDX-License-Identifier: Apache-2.0
// Words are composed and folded by ICU.
#include "rdf/ontology/class_labels.hpp"

#include <unicode/bytestream.h>
#include <unicode/casemap.h>
#include <unicode/normalizer2.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/ascii.hpp"
#include "rdf/ontology/ontology.hpp"

namespace cluxel::rdf {

namespace {

/// The text itself when ICU refuses it.
std::string normalized(const icu::Normalizer2* normalizer, UErrorCode error, std::string_view text) {
  std::string result;
  icu::StringByteSink<std::string> sink(&result);
  if (U_SUCCESS(error))
    normalizer->normalizeUTF8(0, {text.data(), static_cast<std::int32_t>(text.size())}, sink, nullptr, error);
  return U_SUCCESS(error) ? result : std::string(text);
}

bool hasDottedI(std::string_view language) {
  const std::string tag = lowerCase(language.substr(0, language.find('-')));
  return tag == "tr" || tag == "az";
}

std::string withDottedI(const std::string& text) {
  std::string result;
  icu::StringByteSink<std::string> sink(&result);
  UErrorCode error = U_ZERO_ERROR;
  icu::CaseMap::utf8Fold(U_FOLD_CASE_EXCLUDE_SPECIAL_I, {text.data(), static_cast<std::int32_t>(text.size())}, sink,
                         nullptr, error);
  return U_SUCCESS(error) ? result : text;
}

}  // namespace

std::string composedWords(std::string_view text) {
  UErrorCode error = U_ZERO_ERROR;
  const icu::Normalizer2* normalizer = icu::Normalizer2::getNFCInstance(error);
  return normalized(normalizer, error, text);
}

std::string plainWords(std::string_view text, std::string_view language) {
  UErrorCode error = U_ZERO_ERROR;
  const icu::Normalizer2* normalizer = icu::Normalizer2::getNFKCCasefoldInstance(error);
  const std::string words = hasDottedI(language) ? withDottedI(composedWords(text)) : std::string(text);
  std::string plain = normalized(normalizer, error, words);
  plain.erase(std::remove_if(plain.begin(), plain.end(), [](char c) { return c == ' ' || c == '-' || c == '_'; }),
              plain.end());
  return plain;
}

bool isCalled(const ClassLabel& label, std::string_view words) {
  const std::string plain = plainWords(words);
  if (plain.empty()) return false;
  if (plainWords(label.text) == plain) return true;
  return hasDottedI(label.language) && plainWords(label.text, label.language) == plainWords(words, label.language);
}

std::vector<Diagnostic> sharedLabels(const OntologyView& ontology) {
  std::map<std::string, std::set<std::string>> classes;
  for (const OntologyClass& known : ontology.classes)
    for (const ClassLabel& label : known.labels) classes[composedWords(label.text)].insert(known.iri);
  std::vector<Diagnostic> shared;
  for (const auto& [text, iris] : classes) {
    if (iris.size() < 2) continue;
    std::string list;
    for (const std::string& iri : iris) list += (list.empty() ? "<" : ", <") + iri + ">";
    shared.push_back({Severity::Warning,
                      {},
                      "the label '" + text + "' is that of " + std::to_string(iris.size()) + " classes, " + list +
                          ", so it names none of them; give all but one of them another label",
                      {},
                      {}});
  }
  return shared;
}

}  // namespace cluxel::rdf
