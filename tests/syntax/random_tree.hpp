// Random syntax trees such as the parser can make, and a random engine whose numbers are the same everywhere.
#pragma once
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "syntax/ast.hpp"

namespace sysid::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// Uniform on 0 ... n-1; the standard's distributions differ between libraries.
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }
  bool chance(std::size_t one_in) { return below(one_in) == 0; }
  template <class Items>
  auto const& pick(Items const& items) {
    return items[below(std::size(items))];
  }

 private:
  std::mt19937_64 engine_;
};

class RandomTree {
 public:
  explicit RandomTree(std::uint64_t seed) : random_(seed) {}

  ast::File file();
  ast::Expression expression(int depth);
  ast::UnitExpression unit(int depth);

 private:
  ast::Name name();
  ast::Text text();
  double value();
  ast::Number number(int depth);
  ast::Reference reference(int depth = 0);
  ast::Call call(int depth);
  ast::Declared declared();
  ast::Column column();
  ast::FunctionDefinition function();
  ast::ModelStatement model_statement();
  ast::DataStatement data_statement();
  ast::CandidateStatement candidate_statement();
  ast::DictionaryStatement dictionary_statement();
  ast::Task task();
  template <class Make>
  auto several(std::size_t least, Make make) {
    std::vector<decltype(make())> out;
    for (std::size_t n = least + random_.below(4); out.size() < n;) out.push_back(make());
    return out;
  }
  template <class Make>
  auto perhaps(Make make) {
    return random_.chance(2) ? std::optional(make()) : std::nullopt;
  }

  Random random_;
};

}  // namespace sysid::test
