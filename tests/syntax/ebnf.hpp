// Reads grammar/sysid.ebnf and makes random sentences from it.
#pragma once
#include <map>
#include <set>
#include <string>
#include <vector>

#include "random_tree.hpp"

namespace sysid::test {

class Ebnf {
 public:
  /// Throws std::runtime_error where the text is not of the notation its head describes, or names a rule it does not have.
  explicit Ebnf(std::string const& text);

  /// All that stands between double quotes.
  std::set<std::string> const& literals() const { return literals_; }
  /// A sentence of `rule`; beyond `depth` nested rules it ends as soon as it can.
  std::string sentence(std::string const& rule, int depth, Random& random) const;

 private:
  enum class Kind { literal, words, rule, sequence, choice, optional, repetition };
  struct Node {
    Kind kind;
    std::string text;
    std::vector<Node> parts;
  };
  class Reader;

  /// Fewest rules nested in a sentence of the node.
  int height(Node const& node) const;
  void write_rule(std::string const& rule, int depth, Random& random, std::string& out) const;
  void write(Node const& node, int depth, Random& random, std::string& out) const;

  std::map<std::string, Node> rules_;
  std::map<std::string, int> heights_;
  std::set<std::string> literals_;
};

}  // namespace sysid::test
