// SPDX-License-Identifier: Apache-2.0
// What people call a class: its labels, how words are compared with them, and labels that classes share.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/error.hpp"

namespace cluxel::rdf {

struct OntologyView;

/// The property that gives a label, in the order in which labels are chosen to be shown.
enum class LabelKind : std::uint8_t {
  Preferred,   ///< skos:prefLabel
  Plain,       ///< rdfs:label
  Alternative  ///< skos:altLabel, which is never shown
};

struct ClassLabel {
  std::string language;  ///< tag; "" for none
  LabelKind kind = LabelKind::Preferred;
  std::string text;
  auto operator<=>(const ClassLabel&) const = default;
};

/// Words with their characters composed (NFC): "e" and an accent are "é".
std::string composedWords(std::string_view text);
/// Words without case in any script ("Straße" and "STRASSE" are one word), without the differences that Unicode has
/// only for old character sets (NFKC_Casefold), and without blanks and what joins words. Of Turkish and Azerbaijani (by
/// the tag) I is the capital of ı, and İ that of i.
std::string plainWords(std::string_view text, std::string_view language = "");
/// Whether `words` are the label, whatever their case.
bool isCalled(const ClassLabel& label, std::string_view words);

/// A warning for each label that several classes have, as it is written: these words name none of them.
std::vector<Diagnostic> sharedLabels(const OntologyView& ontology);

}  // namespace cluxel::rdf
