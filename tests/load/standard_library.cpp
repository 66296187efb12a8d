// The standard library: pages made of it, and each model against a solution that does not come from it: closed forms, invariants,
// or the published equation integrated here.
#include <array>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <numbers>
#include <set>

#include "app/catalogue/module_page.hpp"
#include "check/checking.hpp"
#include "house/markdown.hpp"
#include "load/modules.hpp"
#include "relative.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

using Vector = std::vector<double>;
using Rates = std::function<Vector(double, Vector const&)>;

// The classical Runge-Kutta method; visit(t, state) after every step.
void integrate(Rates const& rates, Vector state, double step, int steps, std::function<void(double, Vector const&)> const& visit) {
  auto const moved = [](Vector const& from, Vector const& rate, double by) {
    Vector result = from;
    for (std::size_t i = 0; i < from.size(); ++i) result[i] += by * rate[i];
    return result;
  };
  for (int n = 0; n < steps; ++n) {
    double const t = n * step;
    Vector const a = rates(t, state), b = rates(t + step / 2, moved(state, a, step / 2));
    Vector const c = rates(t + step / 2, moved(state, b, step / 2)), d = rates(t + step, moved(state, c, step));
    for (std::size_t i = 0; i < state.size(); ++i) state[i] += step / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
    visit(t + step, state);
  }
}

// A model of the library, or one that has a part of it, driven by given signals.
class Driven {
 public:
  Driven(std::string const& text, std::string const& model, Values parameters, std::function<Values(double)> inputs = {})
      : file_(checked(text)), parameters_(std::move(parameters)), inputs_(std::move(inputs)) {
    for (Model const& each : file_.models)
      if (each.name == model) model_ = &each;
    REQUIRE_MESSAGE(model_ != nullptr, model);
  }
  Vector initial() const {
    Vector state;
    for (sysid::State const& each : model_->states) state.push_back(at(*model_, each.initial, parameters_));
    return state;
  }
  Vector rates(double t, Vector const& state) const {
    Values const values = all(t, state);
    Vector result;
    for (sysid::State const& each : model_->states) result.push_back(at(*model_, each.derivative, values));
    return result;
  }
  void run(double step, int steps, std::function<void(double, Vector const&)> const& visit) const {
    integrate([&](double t, Vector const& state) { return rates(t, state); }, initial(), step, steps, visit);
  }
  double derived(std::string const& name, double t, Vector const& state) const {
    for (Derived const& each : model_->derived)
      if (each.name == name) return at(*model_, each.value, all(t, state));
    FAIL("no derived quantity " << name);
    return 0;
  }

 private:
  Values all(double t, Vector const& state) const {
    Values values = parameters_;
    for (std::size_t i = 0; i < state.size(); ++i) values[model_->states[i].name] = state[i];
    values["t"] = t;
    if (inputs_)
      for (auto const& [name, value] : inputs_(t)) values[name] = value;
    return values;
  }
  CheckedFile file_;
  Model const* model_ = nullptr;
  Values parameters_;
  std::function<Values(double)> inputs_;
};

// A whole that does nothing but drive one part.
std::string bench(std::string const& module, std::string const& part) {
  return "use " + module + "\nmodel bench {\ninput drive\npart law = " + part +
         "\nderive force = law.force\nobserve out ~ normal(law.force, sd = 1)\n}\n";
}
// Displacement and velocity of a drive of 0.02 m that speeds up and turns.
double displacement(double t) { return 0.02 * std::sin(2 * t) + 0.005 * std::sin(7 * t); }
double velocity(double t) { return 0.04 * std::cos(2 * t) + 0.035 * std::cos(7 * t); }

// Largest difference of a law with memory from a published one integrated here, beside the largest force.
double difference(std::string const& part, Values const& parameters, Rates const& published, Vector start,
                  std::function<double(double, Vector const&)> const& force, double step = 1e-4, int steps = 40000) {
  Driven const law(bench("hysteresis", part), "bench", parameters, [](double t) {
    return Values{{"drive", displacement(t)}, {"drive'", velocity(t)}};
  });
  std::vector<double> ours;
  law.run(step, steps, [&](double t, Vector const& state) { ours.push_back(law.derived("law.force", t, state)); });
  double worst = 0, largest = 0;
  std::size_t at = 0;
  integrate(published, std::move(start), step, steps, [&](double t, Vector const& state) {
    worst = std::max(worst, std::fabs(ours[at++] - force(t, state)));
    largest = std::max(largest, std::fabs(force(t, state)));
  });
  REQUIRE(largest > 0);
  return worst / largest;
}

// The force of a law without memory at a value of its input.
double force(std::string const& module, std::string const& part, Values const& parameters, double input, double rate = 0) {
  Driven const law(bench(module, part), "bench", parameters, [=](double) { return Values{{"drive", input}, {"drive'", rate}}; });
  return law.derived("law.force", 0, {});
}

}  // namespace

TEST_CASE("the pages of the standard library are in step with it") {
  for (LibraryModule const& module : library_modules()) {
    auto const path = std::filesystem::path(SYSID_SOURCE_DIR) / "docs/stdlib" / (std::string(module.name) + ".md");
    std::string const page = module_page(module.name).value();
    if (std::getenv("SYSID_BLESS") != nullptr) std::ofstream(path) << page;
    CHECK_MESSAGE(read_file(path) == page, path.string());
    CHECK(module_summary(module).size() > 10);
  }
  CHECK_FALSE(module_page("nothing").has_value());
}

TEST_CASE("linear: free decay is a damped sine") {
  double const m = 2, c = 3, k = 200;
  Driven const model(
      "use oscillators\nmodel bench {\npart body = linear(x = 0 [N])\ninitial body.y = 0.1\nobserve o ~ normal(body.y, sd = "
      "1)\n}\n",
      "bench", {{"body.m", m}, {"body.c", c}, {"body.k", k}});
  double const decay = c / (2 * m), w = std::sqrt(k / m - decay * decay);
  model.run(1e-3, 2000, [&](double t, Vector const& state) {
    CHECK(std::fabs(state[0] - 0.1 * std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t))) < 1e-9);
  });
}

TEST_CASE("duffing: the period of free motion is an elliptic integral") {
  double const k = 100, k3 = 4000, amplitude = 0.2;
  Driven const model(
      "use oscillators\nmodel bench {\npart body = duffing(x = 0 [N], c = 0)\ninitial body.y = 0.2\nobserve o ~ normal(body.y, sd "
      "= 1)\n}\n",
      "bench", {{"body.m", 1}, {"body.k", k}, {"body.k3", k3}});
  // By the arithmetic-geometric mean: K(p) = pi/2 / agm(1, sqrt(1 - p)), period 4 K(p)/w, p = k3 a^2/(2 w^2), w^2 = k + k3 a^2.
  double const w2 = k + k3 * amplitude * amplitude, p = k3 * amplitude * amplitude / (2 * w2);
  double a = 1, b = std::sqrt(1 - p);
  for (int i = 0; i < 8; ++i) {
    double const mean = (a + b) / 2;
    b = std::sqrt(a * b);
    a = mean;
  }
  double const period = 4 * std::numbers::pi / 2 / a / std::sqrt(w2);
  int const steps = 4000;
  model.run(period / steps, steps, [&](double t, Vector const& state) {
    if (t > period * (1 - 1e-9)) CHECK(state[0] == relative(amplitude, 1e-8));
    if (std::fabs(t - period / 4) < 1e-9) CHECK(std::fabs(state[0]) < 1e-8);
  });
}

TEST_CASE("van_der_pol: weakly damped, it settles to twice the amplitude a") {
  double const a = 0.5;
  Driven const model("use oscillators\nmodel bench {\npart body = van_der_pol(x = 0 [N])\nobserve o ~ normal(body.y, sd = 1)\n}\n",
                     "bench", {{"body.m", 1}, {"body.c", 0.1}, {"body.k", 1}, {"body.a", a}, {"body.start", 0.9}});
  double largest = 0;
  model.run(0.02, 10000, [&](double t, Vector const& state) {
    if (t > 180) largest = std::max(largest, std::fabs(state[0]));
  });
  CHECK(largest == doctest::Approx(2 * a).epsilon(0.002));  // 2 a (1 + O(mu^2)), mu = 0.1
}

TEST_CASE("chain: a mode of equal masses and springs swings at its frequency") {
  int const n = 4;
  double const m = 0.5, k = 300;
  std::string text =
      "use oscillators\nmodel bench {\npart row = chain(n = 4, x = 0 [N], m = 0.5, k = 300, c = 0)\ninitial row.q = (";
  int const mode = 2;
  auto const shape = [&](int i) { return std::sin((2 * mode - 1) * std::numbers::pi * i / (2 * n + 1)); };
  for (int i = 1; i <= n; ++i) text += (i == 1 ? "" : ", ") + std::to_string(shape(i));
  Driven const model(text + ")\nobserve o ~ normal(row.q[1], sd = 1)\n}\n", "bench", {});
  double const w = 2 * std::sqrt(k / m) * std::sin((2 * mode - 1) * std::numbers::pi / (4 * n + 2));
  model.run(1e-3, 1000, [&](double t, Vector const& state) {
    for (int i = 1; i <= n; ++i)  // six digits of the initial values are printed; states are q[1], q[1]', q[2], ...
      CHECK(std::fabs(state[static_cast<std::size_t>(2 * i - 2)] - shape(i) * std::cos(w * t)) < 1e-5);
  });
}

TEST_CASE("restoring forces at points on either side of their kinks") {
  Values const p = {{"law.k", 100},    {"law.k3", 5e4},       {"law.k2", -300},
                    {"law.gap", 0.01}, {"law.k_beyond", 900}, {"law.stop", 0.02}};
  for (double const y : {-0.05, -0.01, 0.0, 0.015, 0.03}) {
    CHECK(force("restoring", "linear_spring(displacement = drive)", p, y) == near(100 * y));
    CHECK(force("restoring", "cubic(displacement = drive)", p, y) == near(100 * y + 5e4 * y * y * y));
    CHECK(force("restoring", "quadratic(displacement = drive)", p, y) == near(100 * y - 300 * y * y));
    double const beyond = y > 0.01 ? y - 0.01 : y < -0.01 ? y + 0.01 : 0;
    CHECK(force("restoring", "dead_zone(displacement = drive)", p, y) == doctest::Approx(100 * beyond).epsilon(1e-12));
    CHECK(force("restoring", "bilinear(displacement = drive)", p, y) ==
          doctest::Approx(y < 0.02 ? 100 * y : 2 + 900 * (y - 0.02)).epsilon(1e-12));
  }
}

TEST_CASE("damping forces oppose the velocity") {
  Values const p = {{"law.c", 5}, {"law.c2", 7}, {"law.friction", 3}, {"law.static", 4}, {"law.v_stribeck", 0.1}};
  for (double const v : {-0.3, -0.05, 0.0, 0.1, 2.0}) {
    double const sign = v > 0 ? 1 : v < 0 ? -1 : 0;
    CHECK(force("damping", "viscous(velocity = drive)", p, v) == near(5 * v));
    CHECK(force("damping", "quadratic_damper(velocity = drive)", p, v) == near(7 * v * std::fabs(v)));
    CHECK(force("damping", "coulomb(velocity = drive)", p, v) == 3 * sign);
    CHECK(force("damping", "stribeck(velocity = drive)", p, v) ==
          doctest::Approx((3 + 1 * std::exp(-100 * v * v)) * sign + 5 * v).epsilon(1e-12));
  }
}

TEST_CASE("the families `damping` and `friction` of dictionaries are the laws of the module, coefficient by coefficient") {
  struct Term {
    CheckedDictionary const* of;
    std::size_t index;
    double times;
  };
  struct Law {
    std::string part;
    std::vector<std::pair<std::string, std::vector<Term>>> coefficients;  // each with the terms that it stands before
  };
  auto const family = [](std::string const& terms) {
    return checked("dictionary d {\nstate y [m] = displacement\ntarget = y''\nterms = " + terms + "\n}\n").dictionaries.at(0);
  };
  CheckedDictionary const damping = family("damping(y')"), friction = family("friction(y', stribeck = 0.2 [m/s])");
  std::vector<Law> const laws = {
      {"viscous", {{"c", {{&damping, 0, 1}}}}},
      {"quadratic_damper", {{"c2", {{&damping, 1, 1}}}}},
      {"coulomb", {{"friction", {{&friction, 0, 1}}}}},
      {"stribeck",
       {{"friction", {{&friction, 0, 1}, {&friction, 2, -1}}}, {"static", {{&friction, 2, 1}}}, {"c", {{&friction, 1, 1}}}}}};
  // A law that joins the module joins this table, and the families where they can hold it.
  std::vector<std::string> names, models;
  for (Law const& law : laws) names.push_back(law.part);
  for (LibraryModule const& module : library_modules())
    if (module.name == "damping")
      for (Model const& model : checked(std::string(module.text)).models) models.push_back(model.name);
  CHECK(names == models);
  std::map<CheckedDictionary const*, std::set<std::size_t>> used;
  for (double const v : {-1.7, -0.3, -0.05, 0.0, 0.08, 0.4, 2.0}) {
    auto const value = [&](Term const& term) {
      return term.times * term.of->numbers.graph.evaluate(term.of->numbers.equations.at(0).terms.at(term.index).expression,
                                                          [&](NodeId) { return v; });
    };
    for (Law const& law : laws) {
      CAPTURE(law.part);
      CAPTURE(v);
      Values p = {{"law.v_stribeck", 0.2}};
      for (auto const& [coefficient, terms] : law.coefficients) p["law." + coefficient] = 0;
      double sum = 0, all = 0, next = 3;
      Values together = p;
      for (auto const& [coefficient, terms] : law.coefficients) {
        CAPTURE(coefficient);
        Values alone = p;
        alone["law." + coefficient] = 1;
        sum = 0;
        for (Term const& term : terms) {
          sum += value(term);
          used[term.of].insert(term.index);
        }
        CHECK(force("damping", law.part + "(velocity = drive)", alone, v) == relative(sum, 1e-14));
        together["law." + coefficient] = next;
        all += next * sum;
        next += 2;
      }
      CHECK(force("damping", law.part + "(velocity = drive)", together, v) == relative(all, 1e-14));
    }
  }
  // All that the families hold comes from a law, but the cube, which damping adds.
  CHECK(used[&damping] == std::set<std::size_t>{0, 1});
  CHECK(damping.equations.at(0).terms.size() == 3);
  CHECK(damping.equations.at(0).terms.at(2).text == "y'^3");
  CHECK(used[&friction] == std::set<std::size_t>{0, 1, 2});
  CHECK(friction.equations.at(0).terms.size() == 3);
}

TEST_CASE("morison: drag and inertia of a unit length") {
  CheckedFile const file = checked(
      "use hydrodynamics\nmodel bench {\ninput drive\npart law = morison(velocity = drive)\nobserve o ~ normal(law.force, sd = "
      "1)\n}\n");
  Values const p = {{"law.rho", 1025}, {"law.diameter", 0.5}, {"law.Cd", 0.9}, {"law.Cm", 1.8}, {"drive", -2}, {"drive'", 3}};
  double const area = std::numbers::pi * 0.25 * 0.25;
  CHECK(at(file.models.at(0), file.models.at(0).derived.at(0).value, p) ==
        doctest::Approx(0.5 * 1025 * 0.5 * 0.9 * -2 * 2 + 1025 * area * 1.8 * 3).epsilon(1e-12));
}

TEST_CASE("bouc_wen: Eq. (8.23) for four exponents, and its limit force") {
  double const A = 6000, alpha = 1.5, beta = -0.5;
  for (int const n : {1, 2, 3, 4}) {
    CAPTURE(n);
    Rates const published = [=](double t, Vector const& z) {
      double const v = velocity(t), size = std::fabs(z[0]);
      // The two branches of the printed equation, for v z >= 0 and v z < 0, with alpha + beta and beta - alpha.
      double const slope = v * z[0] >= 0 ? A - (alpha + beta) * std::pow(size, n) : A - (beta - alpha) * std::pow(size, n);
      return Vector{slope * v};
    };
    double const apart = difference("bouc_wen(n = " + std::to_string(n) + ", displacement = drive)",
                                    {{"law.A", A}, {"law.alpha", alpha}, {"law.beta", beta}}, published, {0},
                                    [](double, Vector const& z) { return z[0]; });
    CHECK(apart < 1e-9);  // one equation written in two ways
  }
}

TEST_CASE("dahl: under a steady drive the force rises exponentially to the friction") {
  double const k = 5e4, friction = 20, v = 0.01;
  Driven const law(bench("hysteresis", "dahl(displacement = drive)"), "bench", {{"law.k", k}, {"law.friction", friction}},
                   [=](double t) {
                     return Values{{"drive", v * t}, {"drive'", v}};
                   });
  law.run(1e-3, 500, [&](double t, Vector const& state) {
    CHECK(law.derived("law.force", t, state) == doctest::Approx(friction * (1 - std::exp(-k * v * t / friction))).epsilon(1e-7));
  });
}

TEST_CASE("lugre: in steady sliding the force is Stribeck's") {
  double const k = 1e5, d = 300, c = 40, friction = 3, stiction = 5, vs = 0.002;
  for (double const v : {0.001, 0.004, -0.003}) {
    Driven const law(
        bench("hysteresis", "lugre(displacement = drive)"), "bench",
        {{"law.k", k}, {"law.d", d}, {"law.c", c}, {"law.friction", friction}, {"law.static", stiction}, {"law.v_stribeck", vs}},
        [=](double t) {
          return Values{{"drive", v * t}, {"drive'", v}};
        });
    double last = 0;
    law.run(1e-4, 20000, [&](double t, Vector const& state) { last = law.derived("law.force", t, state); });
    double const sign = v > 0 ? 1 : -1;
    CHECK(last == doctest::Approx((friction + (stiction - friction) * std::exp(-v * v / (vs * vs))) * sign + c * v).epsilon(1e-8));
  }
}

TEST_CASE("jenkins: the play of spring and slider, to what the spring gains in a step") {
  double const k = 2000, yield = 15, step = 1e-4;
  Driven const law(bench("hysteresis", "jenkins(displacement = drive)"), "bench", {{"law.k", k}, {"law.yield", yield}},
                   [](double t) {
                     return Values{{"drive", displacement(t)}, {"drive'", velocity(t)}};
                   });
  // The exact law at discrete times: a trial force cut off at the yield force (elastic predictor, return map).
  double exact = 0, before = 0, worst = 0, largest = 0;
  law.run(step, 40000, [&](double t, Vector const& state) {
    exact = std::clamp(exact + k * (displacement(t) - before), -yield, yield);
    before = displacement(t);
    double const ours = law.derived("law.force", t, state);
    worst = std::max(worst, std::fabs(ours - exact));
    largest = std::max(largest, std::fabs(ours));
  });
  double const gain = k * 0.075 * step;  // the drive is never faster than 0.075 m/s
  CHECK(largest > yield * 0.999);
  CHECK(largest < yield + gain);
  CHECK(worst < 2 * gain);
}

TEST_CASE("iwan: elements that yield one after the other") {
  int const n = 3;
  double const k = 3000, yield = 24, step = 1e-4;
  Driven const law(bench("hysteresis", "iwan(n = 3, displacement = drive)"), "bench", {{"law.k", k}, {"law.yield", yield}},
                   [](double t) {
                     return Values{{"drive", displacement(t)}, {"drive'", velocity(t)}};
                   });
  std::array<double, n> exact{};
  double before = 0, worst = 0;
  law.run(step, 40000, [&](double t, Vector const& state) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      double const limit = yield * (i + 1) / 6.0;  // 1 + 2 + 3 parts
      exact[static_cast<std::size_t>(i)] =
          std::clamp(exact[static_cast<std::size_t>(i)] + k / n * (displacement(t) - before), -limit, limit);
      sum += exact[static_cast<std::size_t>(i)];
    }
    before = displacement(t);
    worst = std::max(worst, std::fabs(law.derived("law.force", t, state) - sum));
  });
  CHECK(worst < 2 * k * 0.075 * step);
}

TEST_CASE("lotka_volterra: what a solution keeps") {
  Driven const model(
      "use populations\nmodel bench {\npart p = lotka_volterra()\nobserve o ~ normal(p.prey, sd = 1)\n}\n", "bench",
      {{"p.prey0", 4}, {"p.predators0", 1.5}, {"p.growth", 1.1}, {"p.predation", 0.4}, {"p.reproduction", 0.1}, {"p.death", 0.4}});
  auto const kept = [](Vector const& s) { return 0.1 * s[0] - 0.4 * std::log(s[0]) + 0.4 * s[1] - 1.1 * std::log(s[1]); };
  double const start = kept(model.initial());
  double least = 100;
  model.run(1e-2, 2000, [&](double, Vector const& state) {
    CHECK(std::fabs(kept(state) - start) < 1e-7);
    least = std::min(least, state[0]);
  });
  CHECK(least < 2);  // it went round
}

TEST_CASE("sir: nobody is lost, and the relation of susceptible and removed") {
  double const population = 1000, transmission = 0.5, recovery = 0.2;
  Driven const model(
      "use populations\nmodel bench {\npart p = sir()\nobserve o ~ normal(p.I, sd = 1)\n}\n", "bench",
      {{"p.population", population}, {"p.infected0", 3}, {"p.transmission", transmission}, {"p.recovery", recovery}});
  Vector last;
  model.run(0.05, 2000, [&](double, Vector const& s) {
    CHECK(s[0] + s[1] + s[2] == doctest::Approx(population).epsilon(1e-12));
    CHECK(std::log(s[0] / 997) == relative(-transmission / (recovery * population) * s[2], 1e-6));
    last = s;
  });
  CHECK(last[2] > 800);
}

TEST_CASE("one_compartment: Bateman's function") {
  double const dose = 1e-4, ka = 1.2, ke = 0.15, V = 0.03;
  Driven const model("use kinetics\nmodel bench {\npart p = one_compartment()\nobserve o ~ normal(p.body, sd = 1)\n}\n", "bench",
                     {{"p.dose", dose}, {"p.ka", ka}, {"p.ke", ke}, {"p.V", V}});
  model.run(0.01, 1000, [&](double t, Vector const& state) {
    CHECK(state[1] / V == relative(dose * ka / (V * (ka - ke)) * (std::exp(-ke * t) - std::exp(-ka * t)), 1e-8));
  });
}
