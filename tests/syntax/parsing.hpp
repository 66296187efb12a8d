// Shared by the syntax tests: parse a text that must be right, or one that must be wrong.
#pragma once
#include <doctest/doctest.h>

#include <string>

#include "syntax/parse.hpp"
#include "syntax/unparse.hpp"

namespace sysid::test {

/// Everything reported for a text, as shown to the user.
inline std::string messages(std::string const& text) {
  Source const source("test.sysid", text);
  Diagnostics diagnostics;
  bool const tree = parse(source, diagnostics).has_value();
  REQUIRE(tree != diagnostics.has_errors());
  return render(diagnostics, source);
}

inline ast::File parsed(std::string const& text) {
  Source const source("test.sysid", text);
  Diagnostics diagnostics;
  auto tree = parse(source, diagnostics);
  INFO(text, "\n", render(diagnostics, source));
  REQUIRE(tree.has_value());
  return *tree;
}

inline ast::Expression parsed_expression(std::string const& text) {
  Source const source("expression", text);
  Diagnostics diagnostics;
  auto tree = parse_expression(source, diagnostics);
  INFO(text, "\n", render(diagnostics, source));
  REQUIRE(tree.has_value());
  return *tree;
}

/// The statements of the only model of a text, its body being given.
inline std::vector<ast::ModelStatement> statements(std::string const& body) {
  ast::File const file = parsed("model m {\n" + body + "\n}\n");
  REQUIRE(file.items.size() == 1);
  return std::get<ast::Model>(file.items.front()).statements;
}

}  // namespace sysid::test
