// Statements put into a block that is there.
#include "repl/work/change.hpp"

#include <doctest/doctest.h>

using namespace sysid;
using namespace sysid::repl;

namespace {

std::string const text =
    "model a {\n  input x [N]\n  state y [m], z [m]\n  initial y = 0, y' = 0, z = 0\n  parameter k = 1  # stiff\n"
    "  y'' + k*y = x\n  z' = y\n  observe d ~ normal(y, sd = 1)\n}";

std::string with(std::string block, std::string const& statement, ItemKind kind = ItemKind::model) {
  WorkItem item{kind, "a", "", std::move(block)};
  WorkItem const changed = with_statement(item, statement, {0, static_cast<std::uint32_t>(statement.size())});
  // What is said to have been typed stands there word for word.
  for (TypedPart const& part : changed.typed)
    CHECK(changed.text.substr(part.in_text.begin, part.in_text.end - part.in_text.begin) ==
          statement.substr(part.in_typed, part.in_text.end - part.in_text.begin));
  CHECK_FALSE(changed.typed.empty());
  return changed.text;
}

std::string replaced(std::string whole, std::string const& from, std::string const& to) {
  REQUIRE(whole.find(from) != std::string::npos);
  return whole.replace(whole.find(from), from.size(), to);
}

}  // namespace

TEST_CASE("a declaration takes the place of that of the same name, whatever word it begins with") {
  CHECK(with(text, "parameter k [N/m] ~ log_uniform(1, 2)") ==
        replaced(text, "parameter k = 1", "parameter k [N/m] ~ log_uniform(1, 2)"));
  CHECK(with(text, "let k = 3") == replaced(text, "parameter k = 1", "let k = 3"));
  CHECK(with(text, "observe d ~ normal(z, sd = 2)") ==
        replaced(text, "observe d ~ normal(y, sd = 1)", "observe d ~ normal(z, sd = 2)"));
}

TEST_CASE("a parameter that loses its unit to a new declaration is told of, one that keeps it or had none is not") {
  WorkItem const before{ItemKind::model, "a", "", replaced(text, "parameter k = 1", "parameter k [N/mm] = 1")};
  auto const lost = [&](std::string const& statement) {
    return lost_units(before, with_statement(before, statement, {0, static_cast<std::uint32_t>(statement.size())}));
  };
  auto const said = lost("parameter k ~ normal(1, sd = 0.1)");
  REQUIRE(said.size() == 1);
  CHECK(said[0].parameter == "k");
  CHECK(said[0].unit == "N/mm");
  CHECK(lost("parameter k [N/m] = 2").empty());
  CHECK(lost("let k = 2 [N/m]").empty());
  CHECK(lost("let k = 2").size() == 1);
  CHECK(lost("constant k = 2").size() == 1);
  CHECK(lost("constant k [N/m] = 2").empty());
  CHECK(lost("let k = c").empty());
  CHECK(lost("parameter c = 2").empty());
}

TEST_CASE("an equation takes the place of that for the same highest derivative") {
  CHECK(with(text, "y'' + k*y + y^3 = x") == replaced(text, "y'' + k*y = x", "y'' + k*y + y^3 = x"));
  CHECK(with(text, "2*z' = y") == replaced(text, "z' = y", "2*z' = y"));
  std::string const one = "model a { state y; y' = -y }";
  CHECK(with(one, "y'' = -y") == "model a { state y; y'' = -y }");
}

TEST_CASE("of a list only what is named is replaced, the rest added") {
  CHECK(with(text, "initial z = 2") == replaced(text, "z = 0", "z = 2"));
  CHECK(with(text, "initial w = 2") == replaced(text, "z = 0", "z = 0, w = 2"));
  CHECK(with(text, "state z [mm]") == replaced(text, "z [m]", "z [mm]"));
  CHECK(with(text, "input u [V], x [kN]") == replaced(text, "input x [N]", "input x [kN]\n  input u [V]"));
}

TEST_CASE("what is new stands with its like, behind the comments of their lines") {
  CHECK(with(text, "parameter c = 2") == replaced(text, "# stiff\n", "# stiff\n  parameter c = 2\n"));
  CHECK(with(text, "derive f = k/2") == replaced(text, "sd = 1)\n", "sd = 1)\n  derive f = k/2\n"));
  CHECK(with("model a { state y; y' = -y }", "parameter k = 1") == "model a { state y\n  parameter k = 1; y' = -y }");
  CHECK(with("model a { y' = -y }", "y = k") == "model a { y' = -y\n  y = k\n }");
}

TEST_CASE("data blocks change likewise") {
  std::string const data =
      "data b { file \"a.csv\"; rate 10 [Hz]; input x = f hold linear; measure d = y; split train = rows 1..5, test = rows 6..9 }";
  CHECK(with(data, "step 1 [ms]", ItemKind::data) == replaced(data, "rate 10 [Hz]", "step 1 [ms]"));
  CHECK(with(data, "input x = g hold cubic", ItemKind::data) ==
        replaced(data, "input x = f hold linear", "input x = g hold cubic"));
  CHECK(with(data, "split test = rows 7..8", ItemKind::data) == replaced(data, "test = rows 6..9", "test = rows 7..8"));
  CHECK(with(data, "split late = rows 9..9", ItemKind::data) == replaced(data, "rows 6..9", "rows 6..9, late = rows 9..9"));
}

TEST_CASE("a block that was typed in the same entry is known on both sides of what is put into it") {
  auto const length = static_cast<std::uint32_t>(text.size());
  WorkItem const item{ItemKind::model, "a", "", text, {}, {{{0, length}, 0}}};
  for (std::string const statement : {"parameter c = 2", "parameter k = 30"}) {
    std::string const whole = text + "\n" + statement;
    WorkItem const changed = with_statement(item, whole, {length + 1, static_cast<std::uint32_t>(whole.size())});
    CHECK(changed.typed.size() == 3);
    std::string typed;
    for (TypedPart const& part : changed.typed) {
      std::string const there = changed.text.substr(part.in_text.begin, part.in_text.end - part.in_text.begin);
      CHECK(there == whole.substr(part.in_typed, there.size()));
      typed += there;
    }
    CHECK(typed.find("y'' + k*y = x\n  z' = y\n  observe d ~ normal(y, sd = 1)\n}") != std::string::npos);
    CHECK(typed.find(statement) != std::string::npos);
  }
}

TEST_CASE("a declaration that is dropped goes with its line") {
  WorkItem const item{ItemKind::model, "a", "", "model a {\n  parameter c = 1\n  parameter k = 1\n  state y, z\n}"};
  CHECK(without_statement(item, "c").text == "model a {\n  parameter k = 1\n  state y, z\n}");
  CHECK(without_statement(item, "q").text == item.text);
  CHECK(without_statement(item, "y").text == item.text);
}

TEST_CASE("a name that is dropped is what is declared under it, in whatever order the block says more of it") {
  std::string const block = "model a {\n  observe y ~ normal(y, sd = 1)\n  state y\n  initial y = 0\n  y' = -y\n}";
  WorkItem const item{ItemKind::model, "a", "", block};
  CHECK(without_statement(item, "y").text == replaced(block, "  state y\n", ""));
  // What is declared elsewhere, as a channel is, goes by its name.
  WorkItem const shown{ItemKind::model, "a", "", replaced(block, "observe y", "observe d")};
  CHECK(without_statement(shown, "d").text == replaced(block, "  observe y ~ normal(y, sd = 1)\n", ""));
  CHECK(without_statement(item, "").text == block);
}

TEST_CASE("an equation is dropped by its text") {
  WorkItem const item{ItemKind::model, "a", "", text};
  CHECK(without_statement(item, "y'' + k*y = x").text == replaced(text, "  y'' + k*y = x\n", ""));
  CHECK(without_statement(item, "z'=y").text == replaced(text, "  z' = y\n", ""));
  CHECK(without_statement(item, "z' = -y").text == text);
}
