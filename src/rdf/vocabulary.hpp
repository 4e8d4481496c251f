// SPDX-License-Identifier: Apache-2.0
// The IRIs used by the code.
#pragma once

#include <string>
#include <string_view>

namespace cluxel::rdf::vocabulary {

inline constexpr std::string_view kClx = "https://w3id.org/cluxel/ontology#";
inline constexpr std::string_view kRdf = "http://www.w3.org/1999/02/22-rdf-syntax-ns#";
inline constexpr std::string_view kRdfs = "http://www.w3.org/2000/01/rdf-schema#";
inline constexpr std::string_view kOwl = "http://www.w3.org/2002/07/owl#";
inline constexpr std::string_view kXsd = "http://www.w3.org/2001/XMLSchema#";
inline constexpr std::string_view kGeo = "http://www.opengis.net/ont/geosparql#";
inline constexpr std::string_view kGeof = "http://www.opengis.net/def/function/geosparql/";
inline constexpr std::string_view kSosa = "http://www.w3.org/ns/sosa/";
inline constexpr std::string_view kProv = "http://www.w3.org/ns/prov#";
inline constexpr std::string_view kDcTerms = "http://purl.org/dc/terms/";
inline constexpr std::string_view kSkos = "http://www.w3.org/2004/02/skos/core#";

/// Resources of a map: `…/map/primitive/<hash>`, `…/map/object/<hash>`, `…/map/cloud/<scan id>`, `…/map/observation/…`.
inline constexpr std::string_view kMap = "https://w3id.org/cluxel/map/";

inline constexpr std::string_view kGraphOntology = "https://w3id.org/cluxel/graph/ontology";
inline constexpr std::string_view kGraphObserved = "https://w3id.org/cluxel/graph/observed";
inline constexpr std::string_view kGraphInferred = "https://w3id.org/cluxel/graph/inferred";
inline constexpr std::string_view kGraphOperator = "https://w3id.org/cluxel/graph/operator";
inline constexpr std::string_view kGraphHistory = "https://w3id.org/cluxel/graph/history";

inline std::string clx(std::string_view local) {
  return std::string(kClx).append(local);
}
inline std::string rdf(std::string_view local) {
  return std::string(kRdf).append(local);
}
inline std::string rdfs(std::string_view local) {
  return std::string(kRdfs).append(local);
}
inline std::string xsd(std::string_view local) {
  return std::string(kXsd).append(local);
}

}  // namespace cluxel::rdf::vocabulary
