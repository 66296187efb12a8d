// Families of terms: `polynomial(y, y', degree = 3)` in a dictionary stands for all its monomials. One row each.
#pragma once
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "syntax/ast.hpp"

namespace sysid {

/// The one option of a generator.
struct GeneratorOption {
  enum class Kind { none, whole, expression };  // whole: a number from 1 to `most`
  std::string_view name = {};
  Kind kind = Kind::none;
  bool needed = false;
  int most = 0;
  std::string_view example = {};
};

struct GeneratorRow {
  std::string_view name;
  std::string_view summary;
  GeneratorOption option;
  /// arguments: at least one. number, expression: the option's value, by its kind; expression is absent where it is not given.
  std::vector<ast::Expression> (*make)(std::span<ast::Expression const> arguments, int number, ast::Expression const* expression,
                                       Span place);
};

/// In the order in which they are listed.
std::span<GeneratorRow const> generators();
std::vector<std::string> generator_names();
GeneratorRow const* find_generator(std::string_view name);

}  // namespace sysid
