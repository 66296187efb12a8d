// Fuzzer: texts changed token by token and statement by statement, with sentences of sysid.ebnf and random trees, so that most
// inputs get past the parser.
#include <cstdint>
#include <cstring>
#include <sstream>

#include "fuzz/stages.hpp"
#include "grammar/message/layout.hpp"
#include "syntax/ebnf.hpp"
#include "syntax/random_tree.hpp"

using sysid::test::Random;

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* bytes, std::size_t size) {
  sysid::fuzz::text(std::string(reinterpret_cast<char const*>(bytes), size));
  return 0;
}

namespace {

sysid::test::Ebnf const& grammar() {
  static sysid::test::Ebnf const ebnf([] {
    std::ifstream const in(SYSID_SOURCE_DIR "/grammar/sysid.ebnf");
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }());
  return ebnf;
}

/// A stretch of the text: a token, or the tokens of a statement.
sysid::Span stretch(sysid::grammar::Layout const& layout, Random& random) {
  std::size_t const at = random.below(layout.tokens.size());
  if (random.chance(2)) return layout.tokens[at].span;
  std::size_t first = at, last = at;
  while (first > 0 && layout.tokens[first - 1].statement == layout.tokens[at].statement) --first;
  while (last + 1 < layout.tokens.size() && layout.tokens[last + 1].statement == layout.tokens[at].statement) ++last;
  return {layout.tokens[first].span.begin, layout.tokens[last].span.end};
}

std::string piece(Random& random) {
  constexpr char const* rules[] = {"expression", "statement", "data_statement", "unit",   "task",     "declared",
                                   "equation",   "call",      "item",           "option", "reference"};
  constexpr char const* words[] = {"y",       "y'",     "y''",  "x", "0", "1e308", "-1", "1e-320",
                                   "sqrt(y)", "log(y)", "1..3", "(", ")", "=",     "~"};
  return random.chance(2) ? grammar().sentence(random.pick(rules), static_cast<int>(random.below(8)), random) : random.pick(words);
}

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* bytes, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t size, std::size_t most, unsigned seed) {
  Random random(seed);
  if (random.chance(20)) return LLVMFuzzerMutate(bytes, size, most);
  std::string text(reinterpret_cast<char const*>(bytes), size);
  if (random.chance(50)) text = sysid::unparse(sysid::test::RandomTree(seed).file());
  for (std::size_t n = 1 + random.below(3); n > 0; --n) {
    sysid::Source const source("fuzz", text);
    sysid::Diagnostics none;
    sysid::grammar::Layout const layout = sysid::grammar::lay_out(source, none, 1);
    if (layout.tokens.empty()) {
      text += piece(random) + "\n";
      continue;
    }
    sysid::Span const here = stretch(layout, random), there = stretch(layout, random);
    std::string const other = text.substr(there.begin, there.end - there.begin);
    switch (random.below(5)) {
      case 0:
        text.erase(here.begin, here.end - here.begin);
        break;
      case 1:
        text.replace(here.begin, here.end - here.begin, other);
        break;
      case 2:
        text.insert(here.end, (random.chance(2) ? "\n" : " ") + other);
        break;
      case 3:
        text.insert(here.end, (random.chance(2) ? "\n" : " ") + piece(random));
        break;
      default:
        text.replace(here.begin, here.end - here.begin, piece(random));
    }
  }
  std::size_t const out = std::min(text.size(), most);
  std::memcpy(bytes, text.data(), out);
  return out;
}
