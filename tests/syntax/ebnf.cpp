// grammar/sysid.ebnf and the parser say the same: what one makes, the other accepts, and they know the same words.
#include "ebnf.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "parsing.hpp"
#include "replications.hpp"
#include "syntax/words.hpp"

namespace sysid::test {

class Ebnf::Reader {
 public:
  explicit Reader(std::string const& text) : text_(text) {}

  bool at_end() { return skip(), at_ == text_.size(); }
  std::string word() {
    skip();
    std::size_t const begin = at_;
    while (at_ < text_.size() && words::continues_name(text_[at_])) ++at_;
    if (at_ == begin) fail("a rule's name");
    return text_.substr(begin, at_ - begin);
  }
  bool take(char c) {
    skip();
    if (at_ == text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void want(char c) {
    if (!take(c)) fail(std::string(1, c));
  }
  Node choice() {
    Node out{Kind::choice, "", {sequence()}};
    while (take('|')) out.parts.push_back(sequence());
    return out;
  }

 private:
  [[noreturn]] void fail(std::string const& wanted) const {
    throw std::runtime_error("sysid.ebnf: expected " + wanted + " at: " + text_.substr(at_, 40));
  }
  void skip() {
    while (at_ < text_.size()) {
      if (text_.compare(at_, 2, "(*") == 0)
        at_ = text_.find("*)", at_) + 2;
      else if (text_[at_] == ' ' || text_[at_] == '\n')
        ++at_;
      else
        return;
    }
  }
  std::string until(char c) {
    std::size_t const begin = at_;
    at_ = text_.find(c, at_);
    if (at_ == std::string::npos) throw std::runtime_error("sysid.ebnf: not closed: " + text_.substr(begin, 40));
    return text_.substr(begin, at_++ - begin);
  }
  Node sequence() {
    Node out{Kind::sequence, "", {}};
    while (skip(), at_ < text_.size() && std::string_view("|;)]}").find(text_[at_]) == std::string_view::npos)
      out.parts.push_back(element());
    return out;
  }
  Node element() {
    Kind kind = Kind::rule;
    if (take('"')) return {Kind::literal, until('"'), {}};
    if (take('?')) return {Kind::words, until('?'), {}};
    char const closer = take('(') ? ')' : take('[') ? ']' : take('{') ? '}' : '\0';
    if (closer == '\0') return {kind, word(), {}};
    kind = closer == ')' ? Kind::sequence : closer == ']' ? Kind::optional : Kind::repetition;
    Node out{kind, "", {choice()}};
    want(closer);
    return out;
  }

  std::string const& text_;
  std::size_t at_ = 0;
};

Ebnf::Ebnf(std::string const& text) {
  for (Reader reader(text); !reader.at_end(); reader.want(';')) {
    std::string const name = reader.word();
    reader.want('=');
    rules_[name] = reader.choice();
  }
  // Heights by iteration to the fixed point, from "never ends".
  for (auto const& [name, node] : rules_) heights_[name] = 1000;
  for (bool changed = true; changed;) {
    changed = false;
    for (auto const& [name, node] : rules_) {
      int const now = height(node) + 1;
      changed = changed || now < heights_[name];
      heights_[name] = std::min(now, heights_[name]);
    }
  }
  auto const collect = [&](auto const& self, Node const& node) -> void {
    if (node.kind == Kind::literal) literals_.insert(node.text);
    for (Node const& part : node.parts) self(self, part);
  };
  for (auto const& [name, node] : rules_) collect(collect, node);
}

int Ebnf::height(Node const& node) const {
  int out = 0;
  switch (node.kind) {
    case Kind::literal:
    case Kind::words:
    case Kind::optional:
    case Kind::repetition:
      for (Node const& part : node.parts) height(part);  // names its rules
      return 0;
    case Kind::rule:
      if (!heights_.contains(node.text)) throw std::runtime_error("sysid.ebnf has no rule " + node.text);
      return heights_.at(node.text);
    case Kind::sequence:
      for (Node const& part : node.parts) out = std::max(out, height(part));
      return out;
    case Kind::choice:
      out = height(node.parts.front());
      for (Node const& part : node.parts) out = std::min(out, height(part));
      return out;
  }
  return out;
}

void Ebnf::write(Node const& node, int depth, Random& random, std::string& out) const {
  switch (node.kind) {
    case Kind::literal:
      // A prime stands directly behind its name; everywhere else blanks mean nothing.
      out += (node.text == "'" ? "" : " ") + node.text;
      return;
    case Kind::words: {
      // The words that may be names stand among the names, but for those that continue a line between blocks.
      constexpr std::array names{"y",     "alpha", "k3",  "σ_ε",  "input", "state", "time",
                                 "model", "data",  "let", "rows", "hold",  "fit",   "inf"};
      constexpr std::array numbers{"0", "1", "500", "2.5", "1e-4", "1E+3", "0.1e3"};
      constexpr std::array texts{"\"\"", "\"a b.csv\"", "\"\\\"\\\\\\n # ;\""};
      if (node.text.find("newline") != std::string::npos)
        out += '\n';
      else if (node.text.find("letter") != std::string::npos)
        out += ' ' + std::string(random.pick(names));
      else if (node.text.find("quotes") != std::string::npos)
        out += ' ' + std::string(random.pick(texts));
      else if (node.text.find("digits") == 1 && node.text.size() < 10)
        out += random.chance(2) ? " 1" : " 12";
      else if (node.text.find("digits") != std::string::npos)
        out += ' ' + std::string(random.pick(numbers));
      else
        throw std::runtime_error("sysid.ebnf: no examples of " + node.text);
      return;
    }
    case Kind::rule:
      write_rule(node.text, depth - 1, random, out);
      return;
    case Kind::sequence:
      for (Node const& part : node.parts) write(part, depth, random, out);
      return;
    case Kind::choice: {
      Node const* part = &random.pick(node.parts);
      if (depth <= 0)
        part = &*std::min_element(node.parts.begin(), node.parts.end(),
                                  [&](Node const& a, Node const& b) { return height(a) < height(b); });
      write(*part, depth, random, out);
      return;
    }
    case Kind::optional:
      if (depth > 0 && random.chance(2)) write(node.parts.front(), depth, random, out);
      return;
    case Kind::repetition:
      for (std::size_t n = depth > 0 ? random.below(3) : 0; n > 0; --n) write(node.parts.front(), depth, random, out);
      return;
  }
}

void Ebnf::write_rule(std::string const& rule, int depth, Random& random, std::string& out) const {
  // Chance makes some sentences explode; a long one ends as soon as it can.
  if (out.size() > 3000) depth = 0;
  std::size_t const begin = out.size();
  do {
    out.resize(begin);
    write(rules_.at(rule), depth, random, out);
    // The side condition of the head: no statement begins with a sign.
  } while (rule == "equation" && out.compare(begin, 2, " -") == 0);
  // Neither does a blank stand inside a path or before an index.
  if (rule == "path") out.erase(std::remove(out.begin() + static_cast<std::ptrdiff_t>(begin) + 1, out.end(), ' '), out.end());
  if (rule == "index") out.erase(begin, 1);
  if (std::size_t const bracket = rule == "element" ? out.find(" [", begin) : std::string::npos; bracket != std::string::npos)
    out.erase(bracket, 1);
}

std::string Ebnf::sentence(std::string const& rule, int depth, Random& random) const {
  std::string out;
  write_rule(rule, depth, random, out);
  return out;
}

}  // namespace sysid::test

using namespace sysid;

namespace {

test::Ebnf const& reference() {
  static test::Ebnf const grammar = [] {
    std::ifstream const in(std::string(SYSID_SOURCE_DIR) + "/grammar/sysid.ebnf");
    std::ostringstream text;
    text << in.rdbuf();
    return test::Ebnf(text.str());
  }();
  return grammar;
}

bool is_word(std::string const& literal) { return words::begins_name(literal[0]); }

}  // namespace

TEST_CASE("the parser accepts every sentence of the reference grammar") {
  test::Random random(1);
  std::size_t longest = 0;
  for (int i = 0; i < 4000; ++i) {
    std::string const text = reference().sentence("file", 4 + i % 12, random);
    longest = std::max(longest, text.size());
    ast::File const tree = test::parsed(text);
    bool const same = test::parsed(unparse(tree)) == tree;
    INFO(text);
    REQUIRE(same);
  }
  CHECK(longest > 1000);
}

TEST_CASE("the parser accepts every statement of the reference grammar") {
  test::Random random(2);
  for (int i = 0; i < replications(400, 1000); ++i) {
    test::parsed("model m {" + reference().sentence("statement", 6 + i % 10, random) + "}");
    test::parsed("data d {" + reference().sentence("data_statement", 6 + i % 10, random) + "}");
    test::parsed("dictionary d {" + reference().sentence("dictionary_statement", 6 + i % 10, random) + "}");
    test::parsed("candidates c {" + reference().sentence("candidate_statement", 6 + i % 10, random) + "}");
    test::parsed(reference().sentence("task", 6 + i % 10, random));
    test::parsed_expression(reference().sentence("expression", 6 + i % 10, random));
  }
}

TEST_CASE("the reference grammar and the tables hold the same words") {
  std::set<std::string> known;
  auto const add = [&](auto const& table) { known.insert(table.begin(), table.end()); };
  add(words::reserved);
  add(words::items);
  add(words::verbs);
  add(words::prepositions);
  add(words::task_words);
  add(words::model_statements);
  add(words::model_words);
  add(words::data_statements);
  add(words::data_words);
  add(words::candidate_words);
  add(words::dictionary_statements);
  std::set<std::string> written;
  for (std::string const& literal : reference().literals())
    if (is_word(literal)) written.insert(literal);
  CHECK(written == known);
}
