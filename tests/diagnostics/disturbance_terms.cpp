// Disturbances that were smoothed along made motions: some follow the states, others are as correlated and do not.
#include "diagnostics/law/disturbance_terms.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/random.hpp"

using namespace sysid;

namespace {

struct Motion {
  std::vector<double> x, v, noise;
};

/// An oscillator under a random force; `noise` is white noise of size 1 through a window of `width` samples, as smoothing leaves
/// it.
Motion motion(std::uint64_t seed, int samples, int width) {
  Stream stream({seed, Purpose::test, 0, 0});
  Motion made;
  std::vector<double> white;
  for (int i = 0; i < samples + width; ++i) white.push_back(stream.normal());
  double x = 0, v = 0;
  for (int i = 0; i < samples; ++i) {
    double const force = 4 * stream.normal();
    for (int k = 0; k < 10; ++k) {
      v += 0.005 * (force - 0.4 * v - 4 * x);
      x += 0.005 * v;
    }
    made.x.push_back(x);
    made.v.push_back(v);
    double sum = 0;
    for (int k = 0; k < width; ++k) sum += white[static_cast<std::size_t>(i + k)];
    made.noise.push_back(sum / std::sqrt(static_cast<double>(width)));
  }
  return made;
}

Model oscillator(bool wandering) {
  Model model;
  for (std::string const name : {"x", "x'"}) {
    State state;
    state.name = name;
    model.states.push_back(state);
  }
  model.states[0].derivative = wandering ? model.graph.leaf(LeafKind::disturbance, 0) : model.graph.leaf(LeafKind::state, 1);
  model.states[1].derivative = model.graph.leaf(LeafKind::state, 0);
  Disturbance disturbance;
  disturbance.name = "w";
  model.disturbances.push_back(disturbance);
  model.dynamics = Dynamics::continuous;
  return model;
}

/// w: of x, x' and the noise, known to `sd`. wandering: x is the integral of w, and x' another state.
template <class Force>
Findings findings(Motion const& of, Force const& force, std::string const& unit = "", bool wandering = false, double sd = 0,
                  std::string const& force_unit = "") {
  Model model = oscillator(wandering);
  if (!unit.empty()) {
    model.states[0].unit = unit_atom(unit);
    model.states[1].unit = divide(*unit_atom(unit), *unit_atom("s"));
    model.disturbances[0].unit = unit_atom("N");
  }
  if (!force_unit.empty()) model.disturbances[0].unit = unit_atom(force_unit);
  Prediction states;
  std::size_t const n = of.x.size();
  states.scored.assign(n, 1);
  std::vector<double> w;
  for (std::size_t i = 0; i < n; ++i) w.push_back(i + 1 < n ? force(of.x[i], of.v[i], of.noise[i]) : std::nan(""));
  states.quantities = {{"x", "", {of.x, {}, {}, {}}, {}, {}},
                       {"x'", "", {of.v, {}, {}, {}}, {}, {}},
                       {"w", "", {w, std::vector<double>(n, sd), {}, {}}, {}, {}}};
  states.quantities[2].average = true;
  return check_disturbance_terms(model, std::vector<Prediction>{states});
}

bool names_term(Findings const& found, std::string const& term) {
  return found.size() == 1 && found.front().code == FindingCode::disturbance_follows_states &&
         found.front().message.find(term) != std::string::npos;
}

}  // namespace

TEST_CASE("a smoothed disturbance that is a term of the states is found, and the term is named") {
  Motion const of = motion(1, 600, 10);
  CHECK(names_term(findings(of, [](double x, double, double e) { return -6 * (x * x * x - 0.5 * x) + 0.3 * e; }), "*x^3,"));
  CHECK(names_term(findings(of, [](double, double v, double e) { return -std::abs(v) * v + 1.45 * v + 0.3 * e; }),
                   "x'"));  // an odd power of it
  CHECK(names_term(findings(of, [](double x, double, double e) { return x * x + 0.1 * e; }), "*x^2,"));
  CHECK(names_term(findings(of, [](double, double v, double e) { return -0.3 * std::tanh(v / 0.1) + 0.1 * e; }), "*tanh(x'/"));
  CHECK(names_term(findings(of, [](double, double, double e) { return 1 + 0.3 * e; }), "the constant 0.9"));
  auto const offset_is_offered = [&](auto const& disturbance) {
    return findings(of, disturbance).front().help.find("if a sensor has an offset") != std::string::npos;
  };
  CHECK(offset_is_offered([](double, double, double e) { return 1 + 0.3 * e; }));
  CHECK_FALSE(offset_is_offered([](double, double v, double e) { return v + 0.1 * e; }));
  CHECK(names_term(findings(of, [](double, double v, double e) { return v + 0.1 * e; }), "*x',"));
}

TEST_CASE("the coefficient of a term is in SI units, whatever the states are declared in") {
  Motion const of = motion(1, 600, 10);
  Findings const found = findings(
      of, [](double x, double, double e) { return -6 * (x * x * x - 0.5 * x) + 0.01 * e; }, "mm");
  REQUIRE(found.size() == 1);
  INFO(found.front().message);
  CHECK(found.front().message.find("e9 [kg/(m^2 s^2)]*x^3") != std::string::npos);
  CHECK(found.front().help.find("`parameter extra [kg/(m^2 s^2)] ~ normal(0, sd = 2") != std::string::npos);
}

TEST_CASE("the coefficient of a term of states without a unit is that of their numbers") {
  Motion const of = motion(1, 600, 10);
  Findings const found = findings(
      of, [](double x, double, double e) { return -6 * (x * x * x - 0.5 * x) + 0.01 * e; }, "", false, 0, "kN");
  REQUIRE(found.size() == 1);
  CHECK(found.front().message.find('[') == std::string::npos);
  CHECK_MESSAGE(found.front().help.find("`parameter extra ~ normal(0, sd = 20000)`") != std::string::npos, found.front().help);
}

TEST_CASE("a smoothed disturbance that is white or slow follows no state") {
  for (std::uint64_t seed = 1; seed <= 40; ++seed)
    for (int const width : {1, 10, 40}) {
      CAPTURE(seed);
      CAPTURE(width);
      CHECK(findings(motion(seed, 500, width), [](double, double, double e) { return e; }).empty());
    }
}

TEST_CASE("a disturbance that hardly shows and was smoothed out of a right record follows no state") {
  // x' = -k x + w, white w of intensity q, x measured with noise of variance R/h: the stationary smoother has the kernel
  // exp(-b |t|), b^2 = k^2 + q/R, and w is x' + k x of what it gives.
  for (double const q : {0.01, 0.5, 5.0})
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      CAPTURE(q);
      CAPTURE(seed);
      constexpr double k = 1, h = 0.1, R = 0.1;
      double const b = std::sqrt(k * k + q / R), gain = q / R / (2 * b);
      Stream stream({seed, Purpose::test, 1, 0});
      constexpr int n = 3000;
      std::vector<double> measured;
      double x = 0;
      for (int i = 0; i < n; ++i) {
        x = std::exp(-k * h) * x + std::sqrt(q * (1 - std::exp(-2 * k * h)) / (2 * k)) * stream.normal();
        measured.push_back(x + std::sqrt(R / h) * stream.normal());
      }
      Motion of;
      std::vector<double> forward(n), backward(n);
      double const keep = std::exp(-b * h);
      for (std::size_t i = 0; i < n; ++i) forward[i] = (i > 0 ? keep * forward[i - 1] : 0) + h * gain * measured[i];
      for (std::size_t i = n; i-- > 0;) backward[i] = i + 1 < n ? keep * (backward[i + 1] + h * gain * measured[i + 1]) : 0;
      for (std::size_t i = 0; i < n; ++i) of.x.push_back(forward[i] + backward[i]);
      double square = 0;
      for (std::size_t i = 0; i < n; ++i) {
        of.noise.push_back(i + 1 < n ? (of.x[i + 1] - of.x[i]) / h + k * (of.x[i + 1] + of.x[i]) / 2 : 0);
        square += of.noise.back() * of.noise.back() / n;
        of.v.push_back(stream.normal());
      }
      REQUIRE(q / h > square);
      CHECK(findings(
                of, [](double, double, double e) { return e; }, "", false, std::sqrt(q / h - square))
                .empty());
    }
}

TEST_CASE("the mean of a disturbance that remembers longer than the record is no missing constant") {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Motion of = motion(seed, 500, 10);
    Stream stream({seed, Purpose::test, 2, 0});
    double w = stream.normal();
    for (double& each : of.noise) {
      w = 0.9995 * w + std::sqrt(1 - 0.9995 * 0.9995) * stream.normal();
      each = w;
    }
    found += findings(of, [](double, double, double e) { return e; }).empty() ? 0 : 1;
  }
  CHECK(found == 0);
}

TEST_CASE("a state that drifts through the record once, moved by the disturbance itself, is followed by nothing") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Motion of = motion(seed, 1500, 10);
    std::vector<double> drop;
    double walk = 5;
    for (std::size_t i = 0; i < of.x.size(); ++i) {
      double const rate = -0.004 * std::exp(-std::pow((static_cast<double>(i) - 900) / 200, 2));
      walk += rate + 0.0005 * of.noise[i];
      of.x[i] = walk;
      drop.push_back(rate + 0.0005 * of.noise[i]);
    }
    of.noise = drop;
    CHECK(findings(
              of, [](double, double, double e) { return e; }, "", true)
              .empty());
  }
}

TEST_CASE("a short record, and a term that is a combination of others, are not judged") {
  CHECK(findings(motion(1, 40, 5), [](double x, double, double) { return x * x * x; }).empty());
  std::vector<double> const a{1, 2, 3, 4}, b{2, 4, 6, 8};
  CHECK_FALSE(followed_term(a, std::vector<std::vector<double>>{b}, a));
}
