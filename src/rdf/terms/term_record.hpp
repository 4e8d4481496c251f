// SPDX-License-Identifier: Apache-2.0
// The record of a term in the dictionary: header byte, datatype id, language, value, text. Equal terms of one store
// have equal records.
#pragma once

#include <string>
#include <string_view>

#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// The fields of a record, as views into it.
struct TermRecord {
  TermKind kind = TermKind::Iri;
  TermId datatype = kNoTerm;  ///< kNoTerm for xsd:string, rdf:langString and non-literals
  std::string_view language, text;
  DecodedValue value;
};

/// The record of `term`; `datatype` is the id of its datatype unless that is xsd:string or rdf:langString.
void encodeTerm(const Term& term, TermId datatype, std::string& bytes);
/// True when the record contains a datatype id.
bool needsDatatypeId(const Term& term);
/// Throws Error (StoreUnavailable) on a malformed record.
TermRecord decodeTerm(std::string_view bytes);

/// The upper 96 bits of the record's hash, the key of the index from terms to ids.
struct TermHash {
  std::uint64_t high = 0;
  std::uint32_t low = 0;
  auto operator<=>(const TermHash&) const = default;
};
TermHash hashOfRecord(std::string_view bytes);

}  // namespace cluxel::rdf
