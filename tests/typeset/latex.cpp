// LaTeX of statements, against what one would type.
#include <doctest/doctest.h>

#include <string>
#include <string_view>

#include "core/text/source.hpp"
#include "syntax/parse.hpp"
#include "typeset/typeset.hpp"

namespace {

sysid::ast::Model model_of(std::string_view statements) {
  sysid::Diagnostics diagnostics;
  sysid::Source const source("t.sysid", "model m {\n" + std::string(statements) + "\n}\n");
  auto const file = sysid::parse(source, diagnostics);
  REQUIRE(file);
  return std::get<sysid::ast::Model>(file->items.front());
}

/// The only line of a model.
std::string latex_of(std::string_view statement) {
  std::string const all = sysid::latex(model_of(statement)), begin = "\\begin{align*}\n  ", end = "\n\\end{align*}\n";
  REQUIRE(all.starts_with(begin));
  REQUIRE(all.ends_with(end));
  return all.substr(begin.size(), all.size() - begin.size() - end.size());
}

/// Of the right side alone.
std::string right(std::string_view expression) {
  std::string const all = latex_of("a = " + std::string(expression));
  return all.substr(std::string_view("a & = ").size());
}

}  // namespace

TEST_CASE("an equation of motion is written as a paper prints it") {
  CHECK(latex_of("m*y'' + c*y' + k*y + k3*y^3 = x") == "m \\, \\ddot{y} + c \\, \\dot{y} + k \\, y + k_{3} \\, {y}^{3} & = x");
  CHECK(latex_of("z' = A*y' - alpha*abs(y')*abs(z)^(n-1)*z - beta*y'*abs(z)^n") ==
        "\\dot{z} & = A \\, \\dot{y} - \\alpha \\, \\left|\\dot{y}\\right| \\, {\\left|z\\right|}^{n - 1} \\, z - \\beta \\, "
        "\\dot{y} "
        "\\, {\\left|z\\right|}^{n}");
}

TEST_CASE("parentheses stand where a reader needs them and nowhere else") {
  CHECK(right("(b + c)*d") == "\\left(b + c\\right) \\, d");
  CHECK(right("(b + c)/(d + e)") == "\\frac{b + c}{d + e}");
  CHECK(right("b/c/d") == "\\frac{\\frac{b}{c}}{d}");
  CHECK(right("(b/c)^2") == "{\\left(\\frac{b}{c}\\right)}^{2}");
  CHECK(right("b/c*d") == "\\frac{b}{c} \\, d");
  CHECK(right("b - (c - d)") == "b - \\left(c - d\\right)");
  CHECK(right("b*-c") == "b \\, \\left(-c\\right)");
  CHECK(right("b - -c") == "b - \\left(-c\\right)");
  CHECK(right("-b^2") == "-{b}^{2}");
  CHECK(right("(-b)^2") == "{\\left(-b\\right)}^{2}");
  CHECK(right("(b^c)^d") == "{\\left({b}^{c}\\right)}^{d}");
  CHECK(right("b^c^d") == "{b}^{{c}^{d}}");
  CHECK(right("sin(b)^2") == "{\\left(\\sin\\left(b\\right)\\right)}^{2}");
  CHECK(right("sqrt(b)^2") == "{\\left(\\sqrt{b}\\right)}^{2}");
  CHECK(right("b^(1/2)") == "{b}^{1\\text{/}2}");
  CHECK(right("-(-b)") == "-\\left(-b\\right)");
  CHECK(right("b - c*d/(2*b)") == "b - \\frac{c \\, d}{2 \\, b}");
}

TEST_CASE("numbers keep apart from factors, large ones become powers of ten") {
  CHECK(right("2*3") == "2 \\cdot 3");
  CHECK(right("b*2") == "b \\cdot 2");
  CHECK(right("5e9*b") == "5 \\cdot {10}^{9} \\, b");
  CHECK(right("1e-12") == "{10}^{-12}");
  CHECK(right("(5e9)^2") == "{\\left(5 \\cdot {10}^{9}\\right)}^{2}");
  CHECK(right("9.81 [m/s^2]*b") == "9.81\\,\\mathrm{m}\\text{/}{\\mathrm{s}}^{2} \\, b");
}

TEST_CASE("names become symbols with indices") {
  CHECK(right("k12 + omega_n + x_max_2 + Cd + beta2 + H2O") ==
        "k_{12} + \\omega_{n} + x_{\\text{max 2}} + \\mathit{Cd} + \\beta_{2} + \\mathit{H2O}");
}

TEST_CASE("elements, parts and derivatives of both") {
  std::string const text = right("q[2]' + spring.z' + y''''");
  CHECK(text == "\\dot{q}_{2} + \\dot{z}_{\\mathrm{spring}} + {y}^{\\left(4\\right)}");
}

TEST_CASE("distributions are named as in print, the normal one by its variance") {
  CHECK(latex_of("observe d ~ normal(y, precision = beta)") == "d & \\sim \\mathcal{N}\\left(y, {\\beta}^{-1}\\right)");
  CHECK(latex_of("observe d ~ normal(y, sd = s)") == "d & \\sim \\mathcal{N}\\left(y, {s}^{2}\\right)");
  CHECK(latex_of("observe d ~ normal(y, sd = s + t)") == "d & \\sim \\mathcal{N}\\left(y, {\\left(s + t\\right)}^{2}\\right)");
  CHECK(latex_of("parameter m [kg] ~ log_uniform(0.1, 10)") ==
        "m & \\sim \\mathrm{LogUniform}\\left(0.1, 10\\right)\\,\\left[\\mathrm{kg}\\right]");
  CHECK(latex_of("function f(u, v) ~ gp(matern52(amplitude = s, length = (a, b)))") ==
        "f\\left(u, v\\right) & \\sim \\mathcal{GP}\\left(\\mathrm{matern52}\\left(\\mathrm{amplitude} = s, \\mathrm{length} = "
        "\\left(a, b\\right)\\right)\\right)");
}

TEST_CASE("conditions stand behind a brace") {
  CHECK(right("if b < c then d else if b >= 2*c then e else 0") ==
        "\\begin{cases} d & \\text{if } b < c \\\\ e & \\text{if } b \\ge 2 \\, c \\\\ 0 & \\text{otherwise} \\end{cases}");
}

TEST_CASE("nothing that follows a brace of conditions can be taken for one of them") {
  CHECK(right("piecewise(b < c, d, e)") == "\\begin{cases} d & \\text{if } b < c \\\\ e & \\text{otherwise} \\end{cases}");
  CHECK(right("piecewise(b < c, d, e)*f").starts_with("\\left(\\begin{cases}"));
  CHECK(right("f + piecewise(b < c, d, e)").ends_with("\\end{cases}\\right)"));
  CHECK(right("(if b < c then d else e)*f").starts_with("\\left(\\begin{cases}"));
}

TEST_CASE("the logarithm of the gamma function has its bars") {
  CHECK(right("lgamma(b)") == "\\ln\\left|\\Gamma\\left(b\\right)\\right|");
}

TEST_CASE("a model is one align environment; declarations without a formula are left out") {
  CHECK(sysid::latex(model_of("input x [N]\nstate y [m]\ninitial y = 0, y' = 1\nk*y = x")) ==
        "\\begin{align*}\n  y\\left(0\\right) & = 0, \\dot{y}\\left(0\\right) = 1 \\\\\n  k \\, y & = x\n\\end{align*}\n");
}

TEST_CASE("definitions are printed with the units that they declare") {
  CHECK(latex_of("derive fn [Hz] = w/(2*pi)") == "\\mathit{fn} & = \\frac{w}{2 \\, \\pi}\\,\\left[\\mathrm{Hz}\\right]");
  CHECK(latex_of("constant g [m/s^2] = 9.81").ends_with("9.81\\,\\left[\\mathrm{m}\\text{/}{\\mathrm{s}}^{2}\\right]"));
  CHECK(latex_of("let w = sqrt(k/m)") == "w & = \\sqrt{\\frac{k}{m}}");
}

TEST_CASE("names that would be printed alike are printed as they are typed, in the whole model") {
  CHECK(sysid::latex(model_of("a = k1 + k2\nb = k_1 + c1")) ==
        "\\begin{align*}\n  a & = \\mathit{k1} + k_{2} \\\\\n  b & = \\mathit{k\\_1} + c_{1}\n\\end{align*}\n");
}

TEST_CASE("the models of a text are LaTeX in its order, each behind its name") {
  sysid::Diagnostics diagnostics;
  auto const tree = sysid::parse(
      sysid::Source("case.sysid", "model one {\n  state y\n  m*y'' + k*y = 0\n}\nmodel two {\n  a = 1\n}\n"), diagnostics);
  REQUIRE(tree);
  std::string const text = sysid::latex(*tree);
  CHECK(text.starts_with("% one\n\\begin{align*}\n"));
  CHECK(text.find("% two\n") > text.find("\\ddot{y}"));
}
