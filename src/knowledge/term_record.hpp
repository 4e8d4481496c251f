// SPDX-License-Identifier: Apache-2.0
// How the dictionary stores a term: a head byte, datatype id, language, value, text. Equal terms of one store
// have equal bytes.
#pragma once

#include <string>
#include <string_view>

#include "cluxel/knowledge/quad_store.hpp"

namespace cluxel {

/// The parts of a stored term; views into the record.
struct TermRecord {
  TermKind kind = TermKind::Iri;
  TermId datatype = kNoTerm;  ///< kNoTerm: no literal, xsd:string or rdf:langString
  std::string_view language, text;
  DecodedValue value;
};

/// The bytes of `term`, whose datatype (unless xsd:string or rdf:langString) has the id `datatype`.
void encodeTerm(const Term& term, TermId datatype, std::string& bytes);
/// True when the record names its datatype by an id.
bool needsDatatypeId(const Term& term);
/// Throws Error (StoreUnavailable) on bytes that no term has.
TermRecord decodeTerm(std::string_view bytes);

/// The upper 96 bits of a hash over a record: what the index from terms to ids sorts by.
struct TermHash {
  std::uint64_t high = 0;
  std::uint32_t low = 0;
  auto operator<=>(const TermHash&) const = default;
};
TermHash hashOfRecord(std::string_view bytes);

}  // namespace cluxel
