// SPDX-License-Identifier: Apache-2.0
// SPARQL 1.1 Service Description: what an endpoint answers, in RDF.
#pragma once

#include <string>

#include "rdf/store/quad_store.hpp"
#include "sparql/results/result_table.hpp"

namespace cluxel::serve {

/// `endpoint` is the absolute URL of the service.
sparql::QueryResult serviceDescription(const rdf::QuadReader& snapshot, const std::string& endpoint,
                                       bool takes_updates);

}  // namespace cluxel::serve
