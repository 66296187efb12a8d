// Dictionaries: what families stand for, which terms are one, what units ask for, how a discovery is configured.
#include <algorithm>

#include "checking.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string const data =
    "data d {\nfile \"d.csv\"\ntime t\ninput x = x [N] hold zero_order\nmeasure displacement = y [mm]\nsplit a = rows 1..10, b = "
    "rows 11..20\n}\n";

CheckedDictionary dictionary(std::string const& statements) {
  return checked("dictionary terms {\ninput x [N]\nstate y [m] = displacement\n" + statements + "\n}\n").dictionaries.at(0);
}
std::vector<std::string> terms(CheckedDictionary const& dictionary, std::size_t equation = 0) {
  std::vector<std::string> all;
  for (DictionaryTerm const& term : dictionary.equations.at(equation).terms) all.push_back(term.text);
  return all;
}
std::vector<std::string> units(CheckedDictionary const& dictionary) {
  std::vector<std::string> all;
  for (DictionaryTerm const& term : dictionary.equations.at(0).terms) all.push_back(term.unit ? term.unit->text : "");
  return all;
}
DiscoverTask task(std::string const& line) {
  auto const file = checked("dictionary terms {\ninput x [N]\nstate y [m] = displacement\ntarget = x\nterms = y, y'\n}\n" + data +
                            "found = discover terms from " + line + "\n");
  return std::get<DiscoverTask>(file.tasks.at(0).what);
}
using Texts = std::vector<std::string>;

// The value of a term where y is 2 and y' is -3, SI.
double value(CheckedDictionary const& dictionary, std::size_t term) {
  Graph const& graph = dictionary.numbers.graph;
  return graph.evaluate(dictionary.numbers.equations.at(0).terms.at(term).expression, [&](NodeId leaf) {
    for (regression::Symbol const& symbol : dictionary.numbers.symbols)
      if (symbol.leaf == leaf && symbol.kind == regression::Symbol::Kind::state) return symbol.order == 0 ? 2.0 : -3.0;
    return 7.0;
  });
}

}  // namespace

TEST_CASE("a polynomial holds every product up to its degree, once") {
  auto const found = dictionary("target = x\nterms = polynomial(y, y', degree = 3)");
  CHECK(terms(found) == Texts{"y", "y'", "y^2", "y*y'", "y'^2", "y^3", "y^2*y'", "y*y'^2", "y'^3"});
  CHECK(value(found, 6) == -12);
  // (n + d choose d) - 1 of n variables and degree d
  CHECK(terms(dictionary("target = x\nterms = polynomial(y, y', y'', degree = 5)")).size() == 55);
}

TEST_CASE("families stand for what could be written by hand") {
  CHECK(terms(dictionary("target = x\nterms = damping(y')")) == Texts{"y'", "abs(y')*y'", "y'^3"});
  CHECK(terms(dictionary("target = x\nterms = friction(y')")) == Texts{"sign(y')", "y'"});
  auto const stribeck = dictionary("target = x\nterms = friction(y', stribeck = 2 [m/s])");
  CHECK(terms(stribeck).size() == 3);
  CHECK(value(stribeck, 2) == relative(-std::exp(-2.25), 1e-14));
  CHECK(terms(dictionary("target = x\nlet angle = y/1 [m]\nterms = trigonometric(angle, harmonics = 2)")) ==
        Texts{"sin(angle)", "cos(angle)", "sin(2*angle)", "cos(2*angle)"});
  CHECK(terms(dictionary("target = x\nterms = x*polynomial(y, degree = 2)")) == Texts{"x*y", "x*y^2"});
  CHECK(terms(dictionary("function damping(v) = 2*v\ntarget = x\nterms = damping(y')")) == Texts{"damping(y')"});
}

TEST_CASE("terms that differ in order or by a constant are one, and the dictionary says so") {
  auto const found =
      dictionary("target = x\nterms = y*y', 3*y'*y, abs(y')*y', y'*abs(-y'), y, polynomial(y, y', degree = 2), 1, 2 [N]");
  CHECK(terms(found) == Texts{"y*y'", "abs(y')*y'", "y", "y'", "y^2", "y'^2", "1"});
  REQUIRE(found.excluded.size() == 5);
  CHECK(found.excluded.at(0).text == "3*y'*y");
  CHECK(found.excluded.at(0).detail == "y*y'");
}

TEST_CASE("a term that is always zero is no constant") {
  auto const found = dictionary("target = x\nterms = y, 0*y, 1");
  CHECK(terms(found) == Texts{"y", "1"});
  REQUIRE(found.excluded.size() == 1);
  CHECK(found.excluded.at(0).text == "0*y");
  CHECK(found.excluded.at(0).why == ExcludedTerm::Why::zero);
}

TEST_CASE("exclusions take out what they name, families too") {
  CHECK(terms(dictionary("target = x\nterms = polynomial(y, y', degree = 2)\nexclude = y'*y, y^2")) == Texts{"y", "y'", "y'^2"});
  CHECK(terms(dictionary("target = x\nterms = polynomial(y, y', degree = 2)\nexclude = polynomial(y', degree = 2)")) ==
        Texts{"y", "y^2", "y*y'"});
}

TEST_CASE("a coefficient has the unit of the target over that of its term") {
  CHECK(units(dictionary("target = x\nterms = y'', y', y, y^3, 1, sign(y')")) == Texts{"kg", "N s/m", "N/m", "N/m^3", "N", "N"});
  CHECK(units(dictionary("state u = control\ntarget = x\nterms = u, y")) == Texts{"", "N/m"});
}

TEST_CASE("a coefficient of a term without a unit is a number of the unit that is written, whatever the states are in") {
  auto const target = [](std::string const& statement, std::string const& unit) {
    CheckedDictionary const of = checked("dictionary terms {\ninput x [N]\nstate y " + unit +
                                         " = displacement\nparameter m [kg]\n" + statement + "\nterms = y, sign(y')\n}\n")
                                     .dictionaries.at(0);
    DictionaryTerm const& sign = of.equations.at(0).terms.back();
    return sign.unit->text + " " + std::to_string(sign.unit->scale) + " " + of.equations[0].unit->text + " " +
           std::to_string(of.equations[0].unit->scale);
  };
  CHECK(target("target = m*y'' - x", "[mm]") == "N 1.000000 N 1.000000");
  CHECK(target("target = m*y'' - x", "[m]") == "N 1.000000 N 1.000000");
  CHECK(target("target = x - m*y''", "[mm]") == "N 1.000000 N 1.000000");
}

TEST_CASE("units prune what coefficients may be") {
  auto const found = dictionary("target = x\nterms = polynomial(y, y', degree = 3)\ncoefficients = [N/mm], [N/m^3]");
  CHECK(terms(found) == Texts{"y", "y^3"});
  CHECK(found.excluded.size() == 7);
  CHECK(found.excluded.at(0).why == ExcludedTerm::Why::unit);
  CHECK(found.excluded.at(0).detail == "N s/m");
  auto const named = dictionary("parameter k3 [N/mm^3]\ntarget = x\nterms = y, k3*polynomial(y, y', degree = 3)");
  CHECK(terms(named) == Texts{"y", "y^3"});
  CHECK(named.equations.at(0).terms.at(1).coefficient == "k3");
  CHECK(units(named) == Texts{"N/m", "N/mm^3"});
  auto const later = dictionary("parameter k [N/mm]\ntarget = x\nterms = polynomial(y, degree = 2), k*y");
  CHECK(terms(later) == Texts{"y", "y^2"});
  CHECK(later.equations.at(0).terms.at(0).coefficient == "k");
  CHECK(units(later) == Texts{"N/mm", "N/m^2"});
}

TEST_CASE("what the target knows is always in, and no term says it again") {
  auto const found = dictionary("parameter m [kg]\nparameter g [m/s^2] = 9.81\ntarget = m*(y'' + g) - x\nterms = y'', y, y', 1");
  REQUIRE(terms(found) == Texts{"m", "y''", "y", "y'", "1"});
  CHECK(found.numbers.equations.at(0).terms.at(0).always);
  // m*(y'' + g) = x + ...: the term of m is -(y'' + g)
  CHECK(value(found, 0) == doctest::Approx(3 - 9.81).epsilon(1e-15));
  auto const merged = dictionary("parameter m [kg]\ntarget = m*y'' - x\nterms = y'', y");
  CHECK(terms(merged) == Texts{"m", "y"});
}

TEST_CASE("several targets are several equations with the same terms") {
  auto const found = checked("dictionary two {\nstate a = a, b = b\ntarget = a', b'\nterms = polynomial(a, b, degree = 2)\n}\n")
                         .dictionaries.at(0);
  REQUIRE(found.equations.size() == 2);
  CHECK(terms(found, 0) == terms(found, 1));
  CHECK(found.numbers.channels.size() == 2);
}

TEST_CASE("a derivative may have a channel of its own") {
  auto const found = dictionary("state z [m] = other, z'' = acceleration\ntarget = x\nterms = y, z, z'");
  REQUIRE(found.numbers.channels.size() == 3);
  CHECK(found.numbers.channels.at(2).order == 2);
  CHECK(found.numbers.channels.at(2).state == 1);
  CHECK(format_dimension(found.measured.channels.at(2).unit->dimension) == "m/s^2");
}

TEST_CASE("a term that contradicts itself is refused where it stands") {
  std::string const said =
      messages("dictionary terms {\ninput x [N]\nstate y [m] = displacement\ntarget = x\nterms = y, y + y'\n}\n");
  CHECK(said.find("test.sysid:5:16: error[E2103]") != std::string::npos);
}

TEST_CASE("a parameter inside terms is open in them, and stands at the median of its prior where numbers are read") {
  CheckedDictionary const inside =
      dictionary("parameter v [mm/s] ~ uniform(1000, 3000)\ntarget = x\nterms = y, tanh(y'/v), v*y/(v + y')");
  REQUIRE(inside.inner.size() == 1);
  CHECK(inside.inner[0].quantity.name == "v");
  CHECK(terms(inside) == Texts{"y", "tanh(y'/v)", "v*y/(v + y')"});
  std::vector<double> const draws = sorted_draws(inside.inner[0], 101);
  CHECK(draws.front() >= 1);
  CHECK(draws.back() <= 3);
  CHECK(value(inside, 1) == std::tanh(-3 / draws[50]));
  CheckedDictionary changed = inside;
  changed.numbers = with_inner(changed.numbers, changed.open, changed.inner, std::vector<double>{2.5});
  CHECK(value(changed, 1) == std::tanh(-3 / 2.5));
  CHECK(value(changed, 2) == 2.5 * 2 / (2.5 - 3));
  CHECK(value(changed, 0) == 2);
}

TEST_CASE("a discovery has a selector and a form of derivatives, stated or by default") {
  DiscoverTask const plain = task("d");
  CHECK(plain.selector == "spike_slab");
  CHECK(plain.form == "weak");
  CHECK_FALSE(plain.candidates);
  DiscoverTask const stated = task("d.a, d.b with ard(derivatives = savitzky_golay), top = 3, candidates = yes, seed = 7");
  CHECK(stated.selector == "ard");
  CHECK(stated.form == "savitzky_golay");
  CHECK(stated.experiments.size() == 2);
  CHECK(stated.top == 3);
  CHECK(stated.candidates);
  CHECK(stated.seed == 7);
}

TEST_CASE("the noise of a temperature counts degrees, whatever the zero points") {
  for (std::string const channel : {"degC", "K"})
    for (std::string const given : {"0.5", "0.5 [degC]", "0.5 [K]", "0.5 [delta_degC]", "0.9 [degF]"}) {
      CAPTURE(channel);
      CAPTURE(given);
      auto const file = checked("dictionary terms {\ninput x [N]\nstate T [" + channel +
                                "] = temperature\ntarget = x\nterms = T, T'\n}\n"
                                "data d {\nfile \"d.csv\"\ntime t\ninput x = x [N] hold zero_order\nmeasure temperature = T\n}\n"
                                "found = discover terms from d with ard, noise(temperature = " +
                                given + ")\n");
      CHECK(std::get<DiscoverTask>(file.tasks.at(0).what).noise.at(0).value() == near(0.5));
    }
}

TEST_CASE("what a discovery cannot be is refused with its code") {
  auto const said = [](std::string const& line) {
    return messages("dictionary terms {\ninput x [N]\nstate y [m] = displacement\ntarget = x\nterms = y, y'\n}\n" + data +
                    "found = discover " + line + "\n");
  };
  CHECK(said("terms from d with spike_slab(derivatives = strong)").find("E6006") != std::string::npos);
  CHECK(said("terms from d with mh").find("E6515") != std::string::npos);
  CHECK(said("terms from d with candidates = perhaps").find("E6006") != std::string::npos);
  CHECK(said("terms from d.a, d.a").find("E6304") != std::string::npos);
  CHECK(said("others from d").find("E6001") != std::string::npos);
  CHECK(said("terms").find("E6009") != std::string::npos);
}
