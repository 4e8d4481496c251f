// SPDX-License-Identifier: Apache-2.0
// Any bytes are taken for a request target, a form, an Accept and a Content-Type header: each is read or refused.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "base/ascii.hpp"
#include "serve/http/media_types.hpp"
#include "serve/http/refusal.hpp"
#include "serve/http/url.hpp"
#include "serve/resources/start_page.hpp"

namespace {

using namespace cluxel::serve;
using cluxel::percentEncoded;

void require(bool holds) {
  if (!holds) std::abort();
}

void readTarget(std::string_view text) {
  try {
    const Target target = parseTarget(text);
    for (const std::string& segment : target.segments) {
      const Target again = parseTarget("/x/" + percentEncoded(segment));
      require(again.segments.size() == 2 && again.segments[1] == segment);
    }
    for (const auto& [name, value] : target.parameters)
      require(parseForm(percentEncoded(name) + "=" + percentEncoded(value)).size() == 1);
    numberOf(target.parameters, "n");
    wholeNumberOf(target.parameters, "limit");
    numbersIn("bbox", valueOf(target.parameters, "bbox").value_or("0"));
  } catch (const Refusal& refusal) {
    require(refusal.status() == 400);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  readTarget(text);
  const auto chosen = negotiate(text, {"application/sparql-results+json", "text/csv", "text/turtle"});
  require(!chosen || *chosen < 3);
  mediaTypeOf(text);
  charsetOf(text);
  require(htmlText(text).find('<') == std::string::npos);
  return 0;
}
