// SPDX-License-Identifier: Apache-2.0
// SPARQL rules of many shapes, for tests of how their facts follow changes.
#pragma once

#include <string>
#include <vector>

#include "mapping/map_inputs.hpp"

namespace cluxel::mapping {

inline const std::string kRulePrefixes =
    "PREFIX clx: <https://w3id.org/cluxel/ontology#> PREFIX rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> ";

inline NamedText rule(const std::string& name, const std::string& text) {
  return {name, kRulePrefixes + text};
}

/// Rules of other shapes: negation, OPTIONAL, MINUS, paths, aggregates over the map, and facts that earlier rules read.
inline std::vector<NamedText> oddRules() {
  return {
      rule("1.rq", "CONSTRUCT { ?a clx:free ?b } WHERE { ?a clx:near ?b FILTER NOT EXISTS { ?a a clx:Avenue } }"),
      rule("2.rq", "CONSTRUCT { ?a clx:beside ?c } WHERE { ?a a clx:Tree . ?a (clx:free|^clx:free)+ ?c }"),
      rule("3.rq",
           "CONSTRUCT { ?a clx:size ?n } WHERE { { SELECT (COUNT(?t) AS ?n) { ?t a clx:Tree } } "
           "?a a clx:Building }"),
      rule("4.rq", "CONSTRUCT { ?a clx:tag ?w } WHERE { ?a a clx:Building OPTIONAL { ?a clx:hasPart ?w } }"),
      rule("5.rq",
           "CONSTRUCT { ?a a clx:Avenue ; clx:tag ?b } WHERE { ?a clx:beside ?b . ?b clx:minX ?x "
           "FILTER(?x > 3) }"),
      rule("6.rq", "CONSTRUCT { ?a clx:lone true } WHERE { ?a clx:near ?b MINUS { ?b clx:near ?c } }"),
      rule("7.rq",
           "CONSTRUCT { ?a clx:free ?a } WHERE { { ?a a clx:Building } UNION { ?a a clx:Vehicle ; "
           "clx:length ?l } }"),
      rule("8.rq", "CONSTRUCT { ?a clx:far ?b } WHERE { ?b clx:hasPart ?c . ?a clx:width ?w ; a ?k . ?k clx:no ?b }"),
      rule("9.rq", "CONSTRUCT { ?w clx:of ?b } WHERE { ?b clx:hasPart/clx:hasPrimitive ?w }")};
}

/// Rules whose solutions change by facts of things that patterns join with the key.
inline std::vector<NamedText> joiningRules() {
  return {rule("1.rq",
               "CONSTRUCT { ?a clx:spot ?x } WHERE { ?a clx:minY ?y . { ?a clx:near ?p } UNION { ?p clx:hasPart ?a } "
               "?p clx:minX ?x }"),
          rule("2.rq",
               "CONSTRUCT { ?a clx:spot ?x } WHERE { ?a clx:minY ?y . { ?a clx:near ?p } UNION { ?p a clx:Building } "
               "?p clx:minX ?x }"),
          rule("3.rq", "CONSTRUCT { ?a clx:beside ?b } WHERE { ?a clx:near ?b . ?b clx:height 5.000000 }"),
          rule("4.rq",
               "CONSTRUCT { ?a clx:at ?g } WHERE { ?a clx:hasPart ?b . ?b clx:hasPrimitive ?c . ?c clx:touchesGround "
               "?g FILTER NOT EXISTS { ?a clx:near ?d } }"),
          rule("5.rq",
               "CONSTRUCT { ?a clx:far ?d } WHERE { ?a clx:minX ?m . { ?a clx:spot ?x } UNION { { ?a clx:at ?b } UNION "
               "{ ?a clx:near ?b } ?b clx:near ?c } ?c clx:minX ?x ; clx:minY ?d }")};
}

/// Rules that give types, for statements to rule some of them out: of one thing, along chains, and read by negation.
inline std::vector<NamedText> typingRules() {
  return {rule("1.rq",
               "CONSTRUCT { ?a a ?k } WHERE { ?a a clx:Barrier ; clx:porosity ?p "
               "BIND(IF(?p > 0.1, clx:Fence, clx:Wall) AS ?k) }"),
          rule("2.rq", "CONSTRUCT { ?a a clx:Avenue } WHERE { ?a a clx:Tree ; clx:minX ?x FILTER(?x < 3) }"),
          rule("3.rq", "CONSTRUCT { ?b a clx:Avenue } WHERE { ?a a clx:Avenue . ?a clx:near ?b }"),
          rule("4.rq", "CONSTRUCT { ?b a clx:Avenue } WHERE { ?b clx:near ?a . ?a a clx:Avenue ; clx:minY ?y }"),
          rule("5.rq", "CONSTRUCT { ?a clx:free ?b } WHERE { ?a clx:near ?b FILTER NOT EXISTS { ?a a clx:Place } }"),
          rule("6.rq", "CONSTRUCT { ?a clx:tag ?p } WHERE { ?a a clx:Fence ; clx:porosity ?p }"),
          rule("7.rq", "CONSTRUCT { ?a a clx:Wall } WHERE { ?a a clx:Barrier ; clx:width ?w }")};
}

/// Rules that read what they derive: along chains and cycles, by joins of their own facts, by paths, by superclasses,
/// and by inverse, symmetric and transitive properties.
inline std::vector<NamedText> recursiveRules() {
  return {rule("reach.rq",
               "CONSTRUCT { ?a clx:reaches ?c } WHERE { { ?a clx:near ?c } UNION { ?a clx:reaches ?b . ?b clx:near ?c "
               "} }"),
          rule("linked.rq",
               "CONSTRUCT { ?a clx:linked ?b . ?b clx:linked ?a } WHERE { { ?a clx:connects ?b } UNION { ?b clx:linked "
               "?a } }"),
          rule("within.rq",
               "CONSTRUCT { ?a clx:within ?c } WHERE { { ?a clx:near ?c } UNION { ?a clx:within ?b . ?b clx:within ?c "
               "} FILTER(?a != ?c) }"),
          rule("place.rq",
               "CONSTRUCT { ?b a clx:Avenue } WHERE { { ?b a clx:Barrier } UNION { ?a clx:near ?b . ?a a clx:Place } "
               "UNION { ?a clx:hasPart ?b . ?a a clx:Place } }"),
          rule("parts.rq", "CONSTRUCT { ?a clx:hasPart ?c } WHERE { ?c clx:partOf ?b . ?b clx:near ?a }"),
          rule("near.rq", "CONSTRUCT { ?b clx:near ?c } WHERE { ?a clx:near ?b . ?a clx:connects|clx:near ?c }"),
          rule("row.rq",
               "CONSTRUCT { ?a clx:row ?c } WHERE { { ?a clx:hasPart ?c } UNION { ?a (clx:row|clx:of)+ ?c "
               ". ?c a clx:Facade } }")};
}

/// Rules in which OPTIONAL, MINUS, BIND or EXISTS stands where the key is not bound: facts about one thing change the
/// solutions of all.
inline std::vector<NamedText> unboundRules() {
  return {
      rule("1.rq", "CONSTRUCT { ?a clx:free ?b } WHERE { MINUS { ?a clx:hasPart ?p } ?a a clx:Tree . ?a clx:near ?b }"),
      rule("2.rq", "CONSTRUCT { ?a clx:tag ?b } WHERE { OPTIONAL { ?a clx:hasPart ?t } ?a a clx:Tree ; clx:near ?b }"),
      rule("3.rq",
           "CONSTRUCT { ?a clx:size ?n } WHERE { { SELECT ?a (COUNT(?b) AS ?n) { OPTIONAL { ?a clx:hasPart ?t } "
           "?a clx:near ?b } GROUP BY ?a } }"),
      rule("4.rq", "CONSTRUCT { ?a clx:lone ?b } WHERE { ?a clx:near ?b { FILTER NOT EXISTS { ?a a clx:Building } } }"),
      rule("5.rq",
           "CONSTRUCT { ?a clx:spot ?p } WHERE { ?a clx:near ?b OPTIONAL { OPTIONAL { ?a clx:hasPart ?p } "
           "?a clx:minX ?x } }"),
      rule("6.rq",
           "CONSTRUCT { ?a clx:far ?b } WHERE { ?a clx:near ?b { ?a a clx:Tree } UNION "
           "{ FILTER NOT EXISTS { ?a clx:hasPart ?p } } }"),
      rule("7.rq", "CONSTRUCT { ?a clx:of ?w } WHERE { BIND(IF(BOUND(?a), 1, 2) AS ?w) ?a clx:near ?b }"),
      rule("8.rq",
           "CONSTRUCT { ?a clx:at ?b } WHERE { { MINUS { ?a clx:hasPart ?p } ?a a clx:Tree } ?a clx:near ?b }")};
}

/// Rules with EXISTS outside of their patterns, and with a BIND that sees a variable before it is bound.
inline std::vector<NamedText> rulesThatAskOutside() {
  return {rule("1.rq",
               "CONSTRUCT { ?a clx:size ?n } WHERE { { SELECT ?a (COUNT(?b) AS ?n) { ?a clx:near ?b } GROUP BY ?a "
               "HAVING(EXISTS { ?a clx:hasPart ?p }) } }"),
          rule("2.rq",
               "CONSTRUCT { ?a clx:tag ?e } WHERE { { SELECT ?a (COUNT(?b) AS ?n) { ?a clx:near ?b } GROUP BY ?a } "
               "BIND(EXISTS { ?a clx:hasPart ?p } AS ?e) }"),
          rule("3.rq",
               "CONSTRUCT { ?a clx:of ?e } WHERE { ?a clx:near ?c { SELECT ?a (EXISTS { ?a clx:hasPart ?p } AS ?e) "
               "{ ?a clx:near ?b } } }"),
          rule("4.rq",
               "CONSTRUCT { ?a clx:at ?e } WHERE { { SELECT ?a ?e { ?a clx:near ?b } GROUP BY ?a "
               "(EXISTS { ?a clx:hasPart ?p } AS ?e) } }"),
          rule("5.rq",
               "CONSTRUCT { ?a clx:far ?y } WHERE { ?a clx:near ?h . BIND(BOUND(?x) AS ?b) ?x clx:hasPart ?y "
               "FILTER(!?b) }")};
}

/// Rules that look at any property. They must not find the derivations that they make themselves.
inline std::vector<NamedText> rulesOfAnyProperty() {
  return {rule("1.rq", "CONSTRUCT { ?a clx:free ?a } WHERE { ?a ?p ?o }"),
          rule("2.rq", "CONSTRUCT { ?a clx:tag ?b } WHERE { ?b a clx:Building . ?a !clx:near ?b }"),
          rule("3.rq", "CONSTRUCT { ?a clx:size 1 } WHERE { { SELECT DISTINCT ?a { ?a ?p ?o } } }"),
          rule("4.rq", "CONSTRUCT { ?a clx:lone ?b } WHERE { ?a clx:near ?b FILTER NOT EXISTS { ?b ?p ?a } }"),
          rule("5.rq", "CONSTRUCT { ?a clx:at ?c } WHERE { ?a a ?c }")};
}

/// Rules in which these stand behind the key, or do not depend on it.
inline std::vector<NamedText> boundRules() {
  return {rule("1.rq", "CONSTRUCT { ?a clx:of ?w } WHERE { BIND(2 AS ?w) ?a clx:near ?b }"),
          rule("2.rq",
               "CONSTRUCT { ?a clx:tag ?w } WHERE { { ?a a clx:Tree } ?a clx:near ?b OPTIONAL { ?a clx:hasPart ?w "
               "FILTER NOT EXISTS { ?a a clx:Building } } }"),
          rule("3.rq",
               "CONSTRUCT { ?a clx:free ?b } WHERE { FILTER NOT EXISTS { ?a clx:hasPart ?p } ?a clx:near ?b "
               "MINUS { ?a a clx:Tree } }")};
}

}  // namespace cluxel::mapping
