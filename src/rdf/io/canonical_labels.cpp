// SPDX-License-Identifier: Apache-2.0
// The names in comments are those of the recommendation.
#include "rdf/io/canonical_labels.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <optional>
#include <utility>

#include "base/content_hash.hpp"

namespace cluxel::rdf {

namespace {

using Label = std::string;
using Hash = std::string;

/// Numbers nodes in the order in which they are asked for (identifier issuer).
class Issuer {
 public:
  explicit Issuer(std::string prefix) : prefix_(std::move(prefix)) {}

  const Label& issue(const Label& node) {
    const auto [place, is_new] = issued_.try_emplace(node);
    if (is_new) {
      place->second = prefix_ + std::to_string(order_.size());
      order_.push_back(node);
    }
    return place->second;
  }
  const Label* find(const Label& node) const {
    const auto known = issued_.find(node);
    return known == issued_.end() ? nullptr : &known->second;
  }
  const std::vector<Label>& order() const { return order_; }
  const std::map<Label, Label>& issued() const { return issued_; }

 private:
  std::string prefix_;
  std::map<Label, Label> issued_;
  std::vector<Label> order_;
};

class TooManyTries : public std::exception {};
constexpr std::size_t kLongestChain = 1000;  ///< of nodes that are followed: each takes its part of the stack

class Canonicalization {
 public:
  Canonicalization(const std::vector<Quad>& quads, std::size_t max_calls) : quads_(quads), calls_left_(max_calls) {
    for (const Quad& quad : quads_)
      for (const Term* term : {&quad.subject, &quad.object, &quad.graph})
        if (term->kind == TermKind::BlankNode) {
          std::vector<const Quad*>& own = quads_of_[term->text];
          if (own.empty() || own.back() != &quad) own.push_back(&quad);
        }
  }

  std::map<Label, Label> run() {
    std::map<Hash, std::vector<Label>> nodes;
    for (const auto& [node, quads] : quads_of_) {
      const Hash& hash = first_degree_.emplace(node, firstDegree(node, quads)).first->second;
      nodes[hash].push_back(node);
    }
    for (const auto& [hash, alike] : nodes)
      if (alike.size() == 1) canonical_.issue(alike.front());
    for (const auto& [hash, alike] : nodes)
      if (alike.size() > 1) issueForAlike(alike);
    return canonical_.issued();
  }

 private:
  /// Hash First Degree Quads: what is said about the node, other nodes without a name.
  static Hash firstDegree(const Label& node, const std::vector<const Quad*>& quads) {
    std::vector<std::string> lines;
    for (const Quad* quad : quads) {
      Quad seen = *quad;
      for (Term* term : {&seen.subject, &seen.object, &seen.graph})
        if (term->kind == TermKind::BlankNode) term->text = term->text == node ? "a" : "z";
      lines.push_back(toNQuads(seen));
    }
    std::sort(lines.begin(), lines.end());
    std::string text;
    for (const std::string& line : lines) text += line;
    return sha256Of(text);
  }

  void issueForAlike(const std::vector<Label>& alike) {
    std::vector<std::pair<Hash, Issuer>> results;
    for (const Label& node : alike) {
      if (canonical_.find(node) != nullptr) continue;
      Issuer issuer("b");
      issuer.issue(node);
      results.push_back(nDegree(node, std::move(issuer)));
    }
    std::stable_sort(results.begin(), results.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [hash, issuer] : results)
      for (const Label& node : issuer.order()) canonical_.issue(node);
  }

  /// Hash Related Blank Node.
  Hash related(const Label& node, const Quad& quad, const Issuer& issuer, char position) const {
    std::string text(1, position);
    if (position != 'g') text += "<" + quad.predicate.text + ">";
    if (const Label* known = canonical_.find(node))
      text += "_:" + *known;
    else if (const Label* issued = issuer.find(node))
      text += "_:" + *issued;
    else
      text += first_degree_.at(node);
    return sha256Of(text);
  }

  std::map<Hash, std::vector<Label>> relatedOf(const Label& node, const Issuer& issuer) const {
    std::map<Hash, std::vector<Label>> by_hash;
    for (const Quad* quad : quads_of_.at(node)) {
      const std::array<std::pair<const Term*, char>, 3> terms{
          {{&quad->subject, 's'}, {&quad->object, 'o'}, {&quad->graph, 'g'}}};
      for (const auto& [term, position] : terms)
        if (term->kind == TermKind::BlankNode && term->text != node)
          by_hash[related(term->text, *quad, issuer, position)].push_back(term->text);
    }
    return by_hash;
  }

  /// Hash N-Degree Quads: what is said about the node and the nodes around it, in the least of all orders.
  std::pair<Hash, Issuer> nDegree(const Label& node, Issuer issuer) {
    if (calls_left_-- == 0 || ++depth_ > kLongestChain) throw TooManyTries();
    std::string text;
    for (auto& [hash, nodes] : relatedOf(node, issuer)) {
      text += hash;
      std::optional<std::pair<std::string, Issuer>> chosen;
      std::vector<Label> order = nodes;
      std::sort(order.begin(), order.end());
      do {
        auto tried = tryOrder(order, issuer, chosen ? &chosen->first : nullptr);
        if (tried && (!chosen || tried->first < chosen->first)) chosen = std::move(tried);
      } while (std::next_permutation(order.begin(), order.end()));
      text += chosen->first;
      issuer = std::move(chosen->second);
    }
    --depth_;
    return {sha256Of(text), std::move(issuer)};
  }

  /// Absent when the path cannot be the least one.
  std::optional<std::pair<std::string, Issuer>> tryOrder(const std::vector<Label>& order, Issuer issuer,
                                                         const std::string* least) {
    if (calls_left_-- == 0) throw TooManyTries();
    std::string path;
    std::vector<Label> to_follow;
    const auto is_larger = [&] { return least != nullptr && path.size() >= least->size() && path > *least; };
    for (const Label& node : order) {
      if (const Label* known = canonical_.find(node)) {
        path += "_:" + *known;
      } else {
        if (issuer.find(node) == nullptr) to_follow.push_back(node);
        path += "_:" + issuer.issue(node);
      }
      if (is_larger()) return std::nullopt;
    }
    for (const Label& node : to_follow) {
      auto [hash, after] = nDegree(node, issuer);
      path += "_:" + issuer.issue(node) + "<" + hash + ">";
      issuer = std::move(after);
      if (is_larger()) return std::nullopt;
    }
    return std::pair{std::move(path), std::move(issuer)};
  }

  const std::vector<Quad>& quads_;
  std::size_t calls_left_, depth_ = 0;
  std::map<Label, std::vector<const Quad*>> quads_of_;
  std::map<Label, Hash> first_degree_;
  Issuer canonical_{"c14n"};
};

}  // namespace

std::map<std::string, std::string> canonicalLabels(const std::vector<Quad>& quads, std::size_t max_calls) {
  try {
    return Canonicalization(quads, max_calls).run();
  } catch (const TooManyTries&) {
    return {};
  }
}

}  // namespace cluxel::rdf
