// Units are compared wherever two of them meet: what is refused and where, what passes, and what is said to do.
#include "check/units/units.hpp"
#include "check/units/changed_power.hpp"

#include "checking.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string const names =
    "time t [s]\ninput x [N]\nstate y [m]\ninitial y = 0, y' = 0\nparameter m [kg] ~ log_uniform(0.1, 10)\n"
    "parameter c [N s/m] ~ log_uniform(2, 200)\nparameter k [N/m] ~ log_uniform(1e3, 1e5)\nparameter k3 [N/m^3] ~ log_uniform(1, "
    "2)\n"
    "parameter f [Hz] = 3\nparameter w [rad/s] = 3\nparameter n = 2\nobserve d ~ normal(y, sd = 1e-3)\n";
std::string const equation = "m*y'' + c*y' + k*y + k3*y^3 = x\n";

std::string with_text(std::string text, std::string const& from, std::string const& to) {
  auto const place = text.find(from);
  REQUIRE(place != std::string::npos);
  return text.replace(place, from.size(), to);
}

struct Said {
  std::string code, primary, secondary, message, help;  // of the first message; texts under the marks
  std::size_t count = 0;
};
Said said_of(std::string const& text) {
  Source source("test.sysid", text);
  Diagnostics diagnostics;
  load(source, diagnostics);
  std::vector<Diagnostic> all = diagnostics.all();
  std::erase_if(all, [](Diagnostic const& each) { return each.code == "E3019"; });  // names that a statement does not use
  if (all.empty()) return {};
  Diagnostic const& first = all.front();
  Said said{first.code, std::string(source.text(first.primary->span)), "", first.message, first.help, all.size()};
  if (!first.secondary.empty()) said.secondary = std::string(source.text(first.secondary.front().span));
  return said;
}
Said with_equation(std::string const& text) { return said_of("model a {\n" + names + text + "\n}\n"); }
Said with(std::string const& statement) { return said_of("model a {\n" + names + equation + statement + "\n}\n"); }

}  // namespace

TEST_CASE("a difference has no zero point, and does not pass for a temperature") {
  auto const atom = [](char const* name) { return unit_atom(name).value(); };
  CHECK(difference(atom("degC")).text == "delta_degC");
  CHECK(difference(atom("degF")).text == "delta_degF");
  CHECK(difference(atom("degF")).scale == atom("degF").scale);
  CHECK(difference(atom("celsius")).offset == 0);
  CHECK(difference(atom("K")).text == "K");
  CHECK(zero_against_difference(atom("degC"), atom("delta_degC")));
  CHECK(zero_against_difference(multiply(divide(atom("K"), atom("W")), atom("W")), atom("degF")));
  CHECK_FALSE(zero_against_difference(atom("degC"), atom("K")));  // a temperature, or a difference: not known
  CHECK_FALSE(zero_against_difference(atom("K"), atom("delta_degC")));
  CHECK_FALSE(zero_against_difference(atom("degC"), atom("degF")));
  CHECK_FALSE(zero_against_difference(atom("degC"), atom("mm")));
}

TEST_CASE("of the terms of an equation the odd one out is shown, on whichever side it stands") {
  CHECK(with_equation(equation).code.empty());
  struct Case {
    std::string equation, odd, against;
  };
  for (Case const& each : {Case{"m*y'' + c*y' + k + k3*y^3 = x", "k", "m*y'' + c*y'"},
                           {"m*y'' + c*y' + k*y + k3*y^2 = x", "k3*y^2", "m*y'' + c*y' + k*y"},
                           {"m*y' + c*y' + k*y + k3*y^3 = x", "m*y'", "c*y' + k*y + k3*y^3"},
                           {"m*y'' = x - c*y - k*y", "c*y", "x"},
                           {"m*y'' + c*y' + k*y = x/m", "x/m", "m*y'' + c*y' + k*y"},
                           {"y'' = x", "x", "y''"},
                           {"m*y'' = -(k*y + c*y) + x", "c*y", "k*y"},
                           {"0 = x - k*y - c*y' - m*y", "m*y", "x - k*y - c*y'"},
                           {"m*y'' + n*y' + c*y + k*y = x", "c*y", "m*y''"}}) {
    CAPTURE(each.equation);
    Said const said = with_equation(each.equation);
    CHECK(said.code == "E2103");
    CHECK(said.primary == each.odd);
    CHECK(said.secondary == each.against);
    CHECK(said.count == 1);
  }
}

TEST_CASE("units are compared in each place where two of them meet") {
  struct Case {
    std::string statement, code, primary, secondary;
  };
  for (Case const& each : {
           Case{"let a = y + k*(y - y')", "E2103", "y'", "y"},
           {"let a = if y > y' then 1 else 2", "E2201", "y", "y'"},
           {"let a = if y == k then 1 else 2", "E2201", "k", "y"},
           {"let a = if y > 0 then k else c", "E2202", "c", "k"},
           {"let a = min(y, 0, c, 1)", "E2203", "c", "y"},
           {"let a = max(y, y', 2*y)", "E2203", "y'", "y"},
           {"let a = hypot(y, y')", "E2203", "y'", "y"},
           {"let a = atan2(k, y)", "E2203", "y", "k"},
           {"let a = clamp(y, -k, k)", "E2203", "y", "-k"},
           {"let a [N] = k", "E2204", "k", "a"},
           {"derive a [J] = k*y^2/m", "E2204", "k*y^2/m", "a"},
           {"constant a [N] = 3 [m]", "E2204", "3 [m]", "a"},
           {"parameter a [N] = 3 [m]", "E2204", "3 [m]", "a"},
           {"parameter a [N] ~ normal(y0, sd = 1)\nparameter y0 [m] = 1", "E2205", "y0", "a"},
           {"parameter a [N] ~ normal(0, sd = 1 [m])", "E2205", "1 [m]", "a"},
           {"parameter a [N] ~ normal(0, variance = 1 [N])", "E2205", "1 [N]", "a"},
           {"parameter a [N] ~ normal(0, precision = 1 [N^2])", "E2205", "1 [N^2]", "a"},
           {"parameter a [N] ~ student_t(0, 4 [m], scale = 1)", "E2205", "4 [m]", "a"},
           {"parameter a [N] ~ gamma(2, rate = 1 [N])", "E2205", "1 [N]", "a"},
           {"parameter a [N] ~ normal(0, sd = 1, upper = 4 [m])", "E2205", "4 [m]", "a"},
           {"parameter a ~ student_t(0, 4 [m], scale = 1)", "E2205", "4 [m]", "a"},
           {"observe e [mm] ~ normal(y', sd = 1)", "E2205", "y'", "e"},
           {"observe e ~ normal(y', sd = y)", "E2205", "y", "y'"},
           {"let a = exp(y)", "E2206", "y", ""},
           {"let a = sin(t)", "E2206", "t", ""},
           {"let a = 2^y", "E2207", "y", ""},
           {"let a = y^(k/c)", "E2207", "(k/c)", ""},
           {"let a = abs(y)^n", "E2208", "abs(y)", "n"},
           {"let a = if y then 1 else 2", "E2209", "y", ""},
           {"let a = if not y and k > 0 then 1 else 2", "E2209", "y", ""},
           {"let a = if y > 0 or k then 1 else 2", "E2209", "k", ""},
       }) {
    CAPTURE(each.statement);
    Said const said = with(each.statement);
    CHECK(said.code == each.code);
    CHECK(said.primary == each.primary);
    CHECK(said.secondary == each.secondary);
    CHECK(said.count == 1);
  }
  CHECK(said_of("model a {\n" + names + equation + "state z [m]\nparameter v [m/s] = 1\ninitial z = v\nz' = v\n}\n").code ==
        "E2204");
  Said const past =
      said_of("model a {\ntime discrete 1 [s]\nstate y [m]\ninitial y = 5 [kg]\ny = lag(y, 1)\nobserve d ~ normal(y, sd = 1)\n}\n");
  CHECK(past.code == "E2204");
  CHECK(past.primary == "5 [kg]");
  Said const guess = said_of(
      "model a {\nstate v [m/s]\nparameter a [m/s^3] = 1\ninitial v = 10, v' = -1 [kg]\n(v')^2 = a*v\nobserve d ~ normal(v, sd = "
      "1)\n}\n");
  CHECK(guess.code == "E2204");
  CHECK(guess.primary == "1 [kg]");
  CHECK(guess.message == "`v'` is in [m/s/s], but this is in [kg]");
  CHECK(said_of("model a {\nstate y [m]\ninitial y = 0, y' = 1 [m]\ny'' = 0\nobserve d ~ normal(y, sd = 1)\n}\n").primary ==
        "1 [m]");
}

TEST_CASE("what agrees passes: numbers adapt, prefixes and pure numbers do not matter, what is undeclared is unchecked") {
  for (std::string const statement : {"let a = 1 + y + 2",
                                      "let a = 3 - y/1 [mm]",
                                      "let a [N] = 5",
                                      "let a = max(y, 0, 3 [mm])",
                                      "let a [kN] = k*y + c*y'",
                                      "let a = if y > 0 and not (y' < 1) then k*y else 0",
                                      "let a = exp(-t/3 [ms])",
                                      "let a = sin(w*t) + cos(30 [deg])",
                                      "let a = sin(2*pi*f*t)",
                                      "let a = n*y + y",
                                      "let a = y^(3/2)*k3",
                                      "let a = 2^n",
                                      "let a = (y/1 [mm])^n",
                                      "let a = abs(y)^2*k3*y",
                                      "let a [deg] = atan2(y', 1 [m/s])",
                                      "let a = sign(y + 1 [m])*k",
                                      "let b = 3\nlet a = b*y + y",
                                      "parameter a [N] ~ normal(k*l, sd = 0.1*k*l, lower = 0)\nconstant l [mm] = 3",
                                      "observe e [mm] ~ normal(y, precision = 1/y^2)",
                                      "function g(a, b) = a + b\nlet a = g(y, 1) + g(y, y)\nlet b = g(k, 2)",
                                      "let a = 1/y + 2 [1/m]",
                                      "let a [percent] = c/(2*sqrt(k*m))",
                                      "let a = y^0.5*1 [m^(1/2)] + y",
                                      "let a [-] = y/(3 [mm]) + 1 [rad]"}) {
    CAPTURE(statement);
    Said const said = with(statement);
    CHECK_MESSAGE(said.code.empty(), said.message);
  }
}

TEST_CASE("the help names what is missing") {
  CHECK(with_equation("m*y'' + c*y' + k + k3*y^3 = x").help == "multiply this by a length, such as `y`");
  // One power of what moves too many or too few: the unit of the coefficient may be the mistake.
  CHECK(with_equation("m*y'' + c*y' + k*y + k3*y^4 = x").help == "declare `k3` in [N/m^4], or divide this term by a length");
  CHECK(with_equation("m*y'' + c*y' + k*y + k3*y^2 = x").help ==
        "declare `k3` in [N/m^2], or multiply this term by a length, such as `y`");
  CHECK(said_of("model a {\nstate y [m]\nparameter k [N/m] = 1\nparameter k3 [N/m^2] = 1\nparameter sigma [m] = 1\ninput x [N]\n"
                "initial y = 0\n1 [N s/m]*y' + k*y + k3*y^3 = x\nobserve d ~ normal(y, sd = sigma)\n}\n")
            .help == "declare `k3` in [N/m^3], or divide this term by a length");
  // In the names that the declaration is written with.
  CHECK(said_of("model a {\nstate y [mm]\nparameter k [N/mm] = 1\nparameter k3 [N/mm^2] = 1\ninput x [N]\n"
                "initial y = 0\n1 [N s/m]*y' + k*y + k3*y^3 = x\nobserve d ~ normal(y, sd = 1)\n}\n")
            .help == "declare `k3` in [N/mm^3], or divide this term by a length");
  // A measured number beside a coefficient is a quantity, 1/2 is none.
  CHECK(with_equation("m*y'' + c*y' + k*y = x + 9.81*m").help == "a number as a factor has no unit: write `9.81 [m/s^2]`");
  CHECK(with_equation("m*y'' + c*y' + k*y = x + 0.5*m").help == "make this a quantity in [N]");
  // A reciprocal coefficient takes the inverse factor; one inside a function or a sum is not a factor of the term.
  CHECK(said_of("model a {\nstate y [m]\nparameter k [N/m] = 1\nparameter h [m/N] = 1\ninput x [N]\n"
                "initial y = 0\n1 [N s/m]*y' + k*y + y^2/h = x\nobserve d ~ normal(y, sd = 1)\n}\n")
            .help == "declare `h` in [m^2/N], or divide this term by a length");
  CHECK(with_equation("m*y'' + c*y' + k*y + (k3 + 1)*y^4 = x").help == "divide this by a length");
  // Not a power of what moves: another name is missing.
  CHECK(said_of("model a {\nstate y [m]\nparameter k [N/m] = 1\nparameter m [kg] = 1\ninitial y = 0, y' = 0\ny'' + k*y = 0\n"
                "observe d ~ normal(y, sd = 1)\n}\n")
            .help == "divide this by a mass, such as `m`");
  CHECK(with_equation("m*y'' + 20*y' + k*y = x").help == "a number as a factor has no unit: write `20 [N s/m]`");
  CHECK(with_equation("m*y'' + c*y' + 100*y = x").help == "a number as a factor has no unit: write `100 [N/m]`");
  CHECK(said_of("model a {\nstate y [m]\nparameter c [N s/m] = 1\nparameter k [N/m] = 1\ninput x [N]\ninitial y = 0\nc*y' + c*y + "
                "k*y = x\n"
                "observe d ~ normal(y, sd = 1)\n}\n")
            .help == "did you mean `y'` instead of `y`, or `c [N/m]`?");
  CHECK(with_equation("m*y'' + c*y + k*y = x").help ==
        "did you mean `y'` instead of `y`, or `c [N/m]`?");  // and not a rate, which `w` is
  // A noise precision has the missing unit by accident.
  CHECK(said_of("model a {\nstate y [m]\nparameter k [N/m] = 1\nparameter k3 [N/m] = 1\nparameter beta [1/m^2] = 1\ninput x [N]\n"
                "initial y = 0\n1 [N s/m]*y' + k*y + k3*y^3 = x\nobserve d ~ normal(y, precision = beta)\n}\n")
            .help == "declare `k3` in [N/m^3]");
  CHECK(with("let a = k*t + x").help.find("t'") == std::string::npos);  // time has no primes
  CHECK(with("let a = exp(y)").help == "divide this by a length");
  CHECK(with("let a = abs(y)^n").help == "make the base a pure number: divide `abs(y)` by a reference value in [m]");
  CHECK(with("let a = if y then 1 else 2").help == "compare it: `y > 0`");
}

TEST_CASE("one mistake gives one message, independent ones several") {
  CHECK(with("let a = k + y\nlet b = a + c\nlet d [N] = b").count == 1);
  CHECK(with("let a = abs(k + y) + c").count == 1);
  CHECK(with("let a [m] = k*y\nlet b = a + y\nderive e [m] = b").count == 1);
  CHECK(with("let a = k + y\nlet b = c + m").count == 2);
  CHECK(with_equation("m*y'' + c*y + k + k3*y^3 = x").count == 1);  // two odd terms of one sum: both are marked
  CHECK(with("function g(a) = a + 1 [m] + 1 [s]\nlet a = g(y) + g(2*y)").count == 1);
}

TEST_CASE("a mistake in the body of a function is told at the call, with the place in the body") {
  Said const said = with("function g(a, b) = a + b\nlet a = 1 + g(y, k)");
  CHECK(said.code == "E2103");
  CHECK(said.primary == "g(y, k)");
  CHECK(said.secondary == "b");
  CHECK(said.message == "in the function `g`: this term cannot be added to the one before it");
  CHECK(with("function g(a) = h(a, 2*a)\nfunction h(a, b) = a + exp(b)\nlet a = g(y)").primary == "g(y)");
}

TEST_CASE("cycles and radians without 2*pi are warned of, with it they are not") {
  for (std::string const statement :
       {"derive fn [Hz] = sqrt(k/m)", "derive wn [rad/s] = 2*f", "let a = sin(f*t)", "let a = cos(n/n*1 + f*t)",
        "let a = f + sqrt(k/m)", "let a = max(w, f)", "derive wn [rad/s] = 6*f",
        "parameter turns [rpm] = 3\nderive v [m/min] = turns*1 [m]", "parameter flow [L/min] = 3\nderive a [rpm] = flow/1 [L]",
        "let a = if w > f then 1 else 0", "derive a [rad/s] = w/(2*pi)", "derive a [Hz] = 2*pi*f", "let a = f^2*y*m + k*y",
        "derive a [N/m] = m*f^2", "let a = y' + f*y", "let a = f*(y - 2*y) - y'", "derive fn [Hz] = (k/m)^(1/2)",
        "parameter a [Hz] ~ normal(w, sd = 1)"}) {
    CAPTURE(statement);
    Said const said = with(statement);
    CHECK(said.code == "E2210");
    CHECK(said.count == 1);
    CHECK(messages("model a {\n" + names + equation + statement + "\n}\n").find("warning[E2210]") != std::string::npos);
  }
  for (std::string const statement : {"derive fn [Hz] = sqrt(k/m)/(2*pi)",
                                      "derive fn [Hz] = sqrt(k/m)/2/pi",
                                      "derive fn [Hz] = 1/(2*pi)*sqrt(k/m)",
                                      "derive wn [rad/s] = 2*pi*f",
                                      "let a = sin(2*pi*f*t)",
                                      "let a = sin(f*2*pi*t)",
                                      "derive T [s] = 1/f",
                                      "derive T [s] = 2*pi/sqrt(k/m)",
                                      "derive a [Hz] = 1/(3 [s])",
                                      "derive a [1/s] = f",
                                      "derive a [1/s] = sqrt(k/m)",
                                      "let a = (2*pi*f)^2*m*y + k*y",
                                      "let a = m*w^2*y + k*y",
                                      "let a = 4*pi^2*f^2*m*y + k*y",
                                      "derive a [N/m] = m*(2*pi*f)^2",
                                      "let a = y' + 2*pi*f*y",
                                      "derive flow [m/s] = 1 [m]*f",
                                      "let a = f*1 [m] + y'",
                                      "let a = exp(-f*t)",
                                      "parameter r [m s/rad] = 1\nlet a = y + r*2*pi*f",
                                      "let a = f*t*2*pi + w*t",
                                      "let wn = 2*pi*f\nlet a = sin(wn*t)",
                                      "derive a [rpm] = w",
                                      "let a = y' + 6.2832*f*y",
                                      "let a = -39.48*f^2*m*y - k*y",
                                      "derive wn [rad/s] = 12.566*f",
                                      "derive wn [rad/s] = 2*3.14159*f",
                                      "derive wn [rad/s] = 2*f*3.1416",
                                      "derive a [N/m] = 39.48*m*f^2",
                                      "derive fn [Hz] = 0.15915*sqrt(k/m)",
                                      "derive Q = sqrt(k*m)/c",
                                      "derive v [m/s] = f*y"}) {
    CAPTURE(statement);
    CHECK_MESSAGE(with(statement).code.empty(), with(statement).message);
  }
}

TEST_CASE("what stays unchecked is listed with its reason") {
  Model const model = model_of(
      "input x\nstate y [m]\ninitial y = 0\nparameter a [1/s] = 1\nparameter b = 1\nlet c = 3\nlet e = 2*b\nlet f = 5\nlet g = 1 "
      "[m]\n"
      "y' = -a*y + b*x + c*y + e*y\nlet h = y^0.37\nlet i = h + y\nobserve d ~ normal(y, sd = 1)");
  std::vector<std::string> lines;
  for (Unchecked const& each : model.unchecked) lines.push_back(each.what + ": " + each.why);
  REQUIRE(lines.size() == 5);
  CHECK(lines[0] == "x: no unit is declared, so `b*x` is not compared");
  CHECK(lines[1] == "b: no unit is declared, so `b*x` and `e*y` are not compared");
  CHECK(lines[2] == "c: a number without a unit, so `c*y` is not compared");
  CHECK(lines[3] == "y: its exponent is neither a whole number nor a fraction of small whole numbers");
  CHECK(lines[4] == "h: its unit is not known");
  CHECK(model_of(names + equation).unchecked.size() == 1);  // n
}

TEST_CASE("Bouc-Wen with units checks for each whole exponent, and only with the unit that belongs to it") {
  // z [N], A [N/m]: each term of z' is in N/s, so alpha and beta are in N^(1-n)/m.
  auto const bouc_wen = [](int n, int unit_of) {
    std::string const e = std::to_string(n), unit = "[N^(1-" + std::to_string(unit_of) + ")/m]";
    return messages(
        "model bouc_wen {\ninput x [N]\nstate y [m], z [N]\ninitial y = 0, y' = 0, z = 0\nparameter m [kg] ~ log_uniform(0.1, 10)\n"
        "parameter c [N s/m] ~ log_uniform(2, 200)\nparameter k [N/m] ~ log_uniform(1e3, 1e5)\n"
        "parameter A [N/m] ~ log_uniform(1e3, 1e5)\nparameter alpha " +
        unit + " ~ uniform(0, 10)\nparameter beta " + unit +
        " ~ uniform(-10, 10)\nm*y'' + c*y' + k*y + z = x\nz' = A*y' - alpha*abs(y')*abs(z)^(" + e + "-1)*z - beta*y'*abs(z)^" + e +
        "\nobserve d ~ normal(y, sd = 1e-3)\n}\n");
  };
  for (int n = 1; n <= 4; ++n) {
    CHECK(bouc_wen(n, n).empty());
    CHECK(bouc_wen(n, n + 1).find("error[E2103]") != std::string::npos);
  }
}

TEST_CASE("names that help proposes as a factor are in scope and not circular") {
  auto const help = [](std::string const& statements) {
    return said_of("model m {\n" + names + equation + statements + "\n}\n").help;
  };
  std::string const hierarchy = "parameter mu ~ normal(0, sd = 1)\n";
  // What is being defined, a `derive`, and a `let` that reads what is being defined.
  std::string const circular = hierarchy + "let q [1/s] = exp(mu)\nlet twice [1/s] = 2*q\nderive fast [1/s] = 3*q\n";
  std::string const said = help(circular);
  for (std::string const name : {"`q`", "`twice`", "`fast`"}) CHECK(said.find(name) == std::string::npos);
  std::string const only = "model m {\nstate y [m]\ninitial y = 1\n" + hierarchy +
                           "let q [1/s] = exp(mu)\ny' = -q*y\nobserve d ~ normal(y, sd = 1e-3)\nderive fast [1/s] = 3*q\n}\n";
  CHECK(said_of(only).help == "multiply this by a rate, such as `1 [1/s]`");
  CHECK(said_of(with_text(only, "exp(mu)", "exp(mu)*1 [1/s]")).count == 0);
  // A parameter of the same unit may stand there.
  CHECK(said_of(with_text(only, "state y", "parameter rate [1/s] ~ log_uniform(1, 2)\nstate y")).help ==
        "multiply this by a rate, such as `rate`");
  // An initial value reads nothing that varies along the record.
  CHECK(said_of("model m {\ninput u [m]\nstate y [m]\nparameter a [-] ~ normal(1, sd = 1)\ninitial y = a\ny' = 1 [1/s]*(u - y)\n"
                "observe d ~ normal(y, sd = 1e-3)\n}\n")
            .help == "multiply this by a length, such as `1 [m]`");
}

TEST_CASE("an option that has one number takes it once") {
  std::string const frame =
      "model m {\ninput x\nstate y\ninitial y = 0\nparameter k ~ normal(0, sd = 1)\ny' = x - k*y\n"
      "observe d ~ normal(y, sd = 1)\n}\ndata b {\nfile \"b.csv\"\ntime t\ninput x = x hold linear\nmeasure d = d\n}\n";
  CHECK(messages(frame + "fit m to b with mh, start = estimated(3, rows = 10)\n").find("error[E4104]: `rows` is given twice") !=
        std::string::npos);
  CHECK(messages(frame + "simulate m with values(k = 1), samples = 9, rate = 1, input x = sine(amplitude = 1, frequency = 0.1, "
                         "hold = linear, hold = cubic)\n")
            .find("error[E4104]: `hold` is given twice") != std::string::npos);
}

TEST_CASE("a coefficient on the wrong side of the fraction line is said so, with the unit that it would else have") {
  auto const decay = [](std::string const& unit, std::string const& rate) {
    return said_of("model a {\nstate y [m]\ninitial y = 1\nparameter k [" + unit + "] ~ log_uniform(1, 2)\ny' = " + rate +
                   "\nobserve d ~ normal(y, sd = 1e-3)\n}\n");
  };
  CHECK(decay("1/h", "-y/k").help == "multiply by `k` instead of dividing by it, or declare `k` in [h]");
  CHECK(decay("min", "-k*y").help == "divide by `k` instead of multiplying by it, or declare `k` in [1/min]");
  CHECK(decay("1/h", "-k*y").count == 0);
  CHECK(decay("h", "-y/k").count == 0);
  // Another power of it, or none, would do.
  CHECK(decay("1/h^2", "-k*y").help.find("instead of multiplying") == std::string::npos);
  CHECK(decay("1/s^3", "-y/k").help == "declare `k` in [s]");
}

TEST_CASE("what a wrong argument gives is not compared with the other terms") {
  Said const said = with_equation("m*y'' + c*y' + k*exp(y) = x");
  CHECK(said.code == "E2206");
  CHECK(said.count == 1);
}

TEST_CASE("a unit changes in the names that it is written with") {
  auto const length = unit_atom("m").value().dimension, time = unit_atom("s").value().dimension;
  auto const per = [](Dimension dimension) {
    for (Rational& each : dimension) each.numerator = -each.numerator;
    return dimension;
  };
  auto const velocity_inverse = divide(*unit_atom("s"), *unit_atom("m")).dimension;
  CHECK(with_changed_power("N/mm^2", per(length)) == "N/mm^3");
  CHECK(with_changed_power("N/mm", length) == "N");
  CHECK(with_changed_power("mm", per(length)).empty());  // a pure number
  CHECK(with_changed_power("1/mm", per(length)) == "1/mm^2");
  CHECK(with_changed_power("N ms/mm", time) == "N ms^2/mm");
  CHECK(with_changed_power("N s/m", velocity_inverse) == "N s^2/m^2");
  CHECK(with_changed_power("N/(mm ms)", per(time)) == "N/(mm ms^2)");
  // No name for it, or two.
  CHECK(with_changed_power("N", length).empty());
  CHECK(with_changed_power("mm/m", length).empty());
  CHECK(with_changed_power("Hz", per(time)).empty());
  CHECK(with_changed_power("N^(1/2)/m", length).empty());
}
