// The places kept in the tree.
#include "parsing.hpp"

using namespace sysid;

namespace {

struct Spans {
  Source source;
  ast::File file;
  explicit Spans(std::string const& text) : source("test.sysid", text), file(test::parsed(text)) {}
  std::string_view operator()(ast::Located const& node) const { return source.text(node.span); }
};

}  // namespace

TEST_CASE("a span covers the words of its node without blanks and comments around it") {
  Spans const text(
      "model  m \"title\" {  # comment\n"
      "  parameter  k [N / m]  ~ normal( 0 , sd = 2*s ) # comment\n"
      "  m*y'' + (a + b)*y^2  = -x   ; let c = if a then b else 3 [m]\n"
      "}\n");
  auto const& model = std::get<ast::Model>(text.file.items[0]);
  CHECK(text(model).starts_with("model  m"));
  CHECK(text(model).ends_with("\n}"));
  CHECK(text(model.name) == "m");
  CHECK(text(*model.title) == "\"title\"");

  auto const& parameter = std::get<ast::ParameterDeclaration>(model.statements[0]);
  CHECK(text(parameter) == "parameter  k [N / m]  ~ normal( 0 , sd = 2*s )");
  CHECK(text(parameter.name) == "k [N / m]");
  CHECK(text(parameter.name.name) == "k");
  CHECK(text(*parameter.name.unit) == "N / m");
  CHECK(text(parameter.name.unit->factors[1]) == "m");
  CHECK(text(*parameter.prior) == "normal( 0 , sd = 2*s )");
  CHECK(text(parameter.prior->arguments[1]) == "sd = 2*s");
  CHECK(text(*parameter.prior->arguments[1].name) == "sd");
  CHECK(text(parameter.prior->arguments[1].value) == "2*s");

  auto const& equation = std::get<ast::Equation>(model.statements[1]);
  CHECK(text(equation) == "m*y'' + (a + b)*y^2  = -x");
  CHECK(text(equation.left) == "m*y'' + (a + b)*y^2");
  CHECK(text(equation.right) == "-x");
  auto const& sum = *std::get<ast::Box<ast::Binary>>(equation.left.node);
  CHECK(text(sum) == "m*y'' + (a + b)*y^2");
  CHECK(text(*sum.left) == "m*y''");
  CHECK(text(*sum.right) == "(a + b)*y^2");
  auto const& product = *std::get<ast::Box<ast::Binary>>(sum.right->node);
  CHECK(text(*product.left) == "(a + b)");
  CHECK(text(*std::get<ast::Box<ast::Binary>>(product.left->node)) == "a + b");
  CHECK(text(*product.right) == "y^2");
  CHECK(text(*std::get<ast::Box<ast::Unary>>(equation.right.node)->operand) == "x");

  auto const& definition = std::get<ast::Definition>(model.statements[2]);
  CHECK(text(definition) == "let c = if a then b else 3 [m]");
  CHECK(text(definition.value) == "if a then b else 3 [m]");
  CHECK(text(*std::get<ast::Box<ast::Conditional>>(definition.value.node)->otherwise) == "3 [m]");
}

TEST_CASE("a span over continued lines covers them") {
  Spans const text("p = fit a to b.c\n  with mh(samples =\n 10), start = rest # end\n");
  auto const& task = std::get<ast::Task>(text.file.items[0]);
  CHECK(text(task) == "p = fit a to b.c\n  with mh(samples =\n 10), start = rest");
  CHECK(text(task.data.front()) == "b.c");
  CHECK(text(task.options[0]) == "mh(samples =\n 10)");
  CHECK(text(task.options[1]) == "start = rest");
}

TEST_CASE("spans of columns, rows and initial values are their own") {
  Spans const text(
      "data d {\n split a = rows 1 .. 20 , b = rows 3..4\n measure c = \"y 1\"  [mm]\n}\nmodel m { initial y' = 0 , z = 1 }");
  auto const& data = std::get<ast::Data>(text.file.items[0]);
  auto const& split = std::get<ast::DataSplit>(data.statements[0]);
  CHECK(text(split.parts[0]) == "a = rows 1 .. 20");
  CHECK(text(split.parts[0].last) == "20");
  CHECK(text(std::get<ast::DataMeasure>(data.statements[1]).column) == "\"y 1\"  [mm]");
  auto const& initial = std::get<ast::InitialDeclaration>(std::get<ast::Model>(text.file.items[1]).statements[0]);
  CHECK(text(initial.values[0].state) == "y'");
  CHECK(text(initial.values[0]) == "y' = 0");
}
