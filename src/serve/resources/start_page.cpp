// SPDX-License-Identifier: Apache-2.0
// The list of resources as HTML.
#include "serve/resources/start_page.hpp"

#include <array>

#include "base/ascii.hpp"
#include "serve/http/url.hpp"

namespace cluxel::serve {

namespace {

struct Link {
  const char* path;
  const char* text;
};

constexpr std::array<Link, 8> kLinks{{{"/page", "points, objects and questions as a page"},
                                      {"", "what the map holds (JSON)"},
                                      {"/objects", "objects (JSON): class, bbox, limit, offset"},
                                      {"/questions", "shipped questions (JSON)"},
                                      {"/questions/count_by_class?format=table", "objects of each class (text)"},
                                      {"/tasks", "tasks with their parameters (JSON); /tasks/NAME runs one"},
                                      {"/sparql", "SPARQL 1.1 endpoint; without a query its Service Description"},
                                      {"/graph?default", "all facts (Turtle)"}}};

constexpr const char* kHead = R"(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>Cluxel</title>
<style>
:root { color-scheme: light dark; }
body { font: 1rem/1.5 system-ui, sans-serif; max-width: 44rem; margin: 3rem auto; padding: 0 1rem; }
textarea { width: 100%; font: .9rem/1.4 ui-monospace, monospace; box-sizing: border-box; }
</style>
</head>
<body>
<h1>Cluxel</h1>
)";

std::string formOf(const std::string& base) {
  return "<form action=\"" + base + "/sparql\" method=\"get\">\n<p><label for=\"query\">SPARQL query</label></p>\n" +
         "<textarea id=\"query\" name=\"query\" rows=\"6\">" +
         htmlText(
             "PREFIX clx: <https://w3id.org/cluxel/ontology#>\nSELECT ?object ?height\nWHERE { ?object a clx:Tree ; "
             "clx:height ?height }\nORDER BY DESC(?height)") +
         "</textarea>\n<input type=\"hidden\" name=\"format\" value=\"table\">\n<p><button>Ask</button></p>\n</form>\n";
}

}  // namespace

std::string htmlText(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

HttpResponse startPage(const std::vector<std::string>& map_names) {
  std::string html = kHead;
  for (const std::string& name : map_names) {
    const std::string base = "/maps/" + percentEncoded(name);
    html += "<h2>" + htmlText(name) + "</h2>\n<ul>\n";
    for (const Link& link : kLinks)
      html += "<li><a href=\"" + base + htmlText(link.path) + "\">" + link.text + "</a></li>\n";
    html += "</ul>\n" + (map_names.size() == 1 ? formOf(base) : "");
  }
  html += "</body>\n</html>\n";
  return {200,
          "text/html; charset=utf-8",
          std::move(html),
          {{"Content-Security-Policy", "default-src 'none'; style-src 'unsafe-inline'; form-action 'self'"}}};
}

}  // namespace cluxel::serve
