// Exported Stan programs against what Stan said of them when they were recorded (fixtures/make_stan.py), and what is refused.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/session/fit_target.hpp"
#include "core/system/digest.hpp"
#include "exchange/exported.hpp"
#include "exchange/stan_names.hpp"
#include "exchange/stan_program.hpp"
#include "exchange/stan_text.hpp"
#include "experiment/experiments.hpp"
#include "report/file/csv.hpp"

using namespace sysid;
using namespace sysid::testing;
using json = nlohmann::json;

namespace {

/// A shipped model, read and checked, or another text in its place.
class Opened {
 public:
  Opened(std::filesystem::path const& path, std::string const& text) : source_(path.string(), text) {
    Diagnostics diagnostics;
    file_ = load(source_, diagnostics);
    if (!file_) throw UserError(diagnostics.all().front());
    session_.emplace(source_, *file_, options_, silent_, out_, out_);
  }

  Session& session() { return *session_; }
  Task const& task(std::string const& name) const {
    for (Task const& each : file_->tasks)
      if (each.name == name) return each;
    throw std::runtime_error("no task " + name);
  }

 private:
  Source source_;
  std::optional<CheckedFile> file_;
  RunOptions options_;
  SilentProgress silent_;
  std::ostringstream out_;
  std::optional<Session> session_;
};

/// What stands before a comma is a shipped model.
std::filesystem::path path_of(std::string const& name) {
  std::string const model = name.substr(0, name.find(','));
  return models / model / (model + ".sysid");
}

std::string text_of(std::string const& name) {
  std::string const text = read_file(path_of(name));
  if (name == "fleet, exact") return with(text, "thin = 10), seed = 1", "thin = 10), seed = 1, solver = exponential");
  return name == "silverbox" ? with(text, "start = estimated(rows = 50)", "start = rest") : text;
}

/// log prior + log likelihood of declared values, without the Jacobian.
double log_density(ModelTarget const& target, json const& values) {
  LaneArray declared(target.dimension(), 1), theta(target.dimension(), 1);
  for (int p = 0; p < target.dimension(); ++p)
    declared(p, 0) = values.at(stan_name(target.parameters()[static_cast<std::size_t>(p)].name)).get<double>();
  target.unconstrain(declared, theta);
  double prior = 0, likelihood = 0;
  Ledger ledger;
  target.log_prior(theta, std::span(&prior, 1), false);
  target.log_likelihood(theta, std::span(&likelihood, 1), ledger);
  return prior + likelihood;
}

std::string refusal(std::string const& name, std::string const& text, std::string const& task) {
  Opened opened(models / name / (name + ".sysid"), text);
  try {
    stan_program(opened.session(), opened.task(task), std::get<FitTask>(opened.task(task).what).solver);
  } catch (UserError const& error) {
    return error.what();
  }
  return "nothing was refused";
}

/// A program without the comments that begin it, which name the version of this program.
std::string_view without_head(std::string_view program) {
  while (program.starts_with("//")) program.remove_prefix(program.find('\n') + 1);
  return program;
}

}  // namespace

TEST_CASE("Stan gives exported programs the log density that we do") {
  json const record = json::parse(read_file(scripts / "fixtures/stan.json"));
  CHECK(record.size() == 8);
  for (auto const& [name, recorded] : record.items()) {
    CAPTURE(name);
    Opened opened(path_of(name), text_of(name));
    Task const& task = opened.task(recorded.at("task"));
    FitTask const& fit = std::get<FitTask>(task.what);
    StanProgram const program = stan_program(opened.session(), task, fit.solver);
    // What was recorded is of these programs: after a change of them fixtures/make_stan.py asks Stan again.
    CHECK(sha256(without_head(program.program)) == recorded.at("program_sha256"));
    CHECK(sha256(program.data) == recorded.at("data_sha256"));
    auto const compiled = opened.session().compiled(fit, false, fit.solver.method, fit.prediction);
    auto const space = parameter_space(compiled->model, fit.experiments);
    auto const data = load_experiments(opened.session(), fit.experiments, compiled->model, fit.start, fit.prediction);
    auto const target = make_fit_target(opened.session(), fit, compiled, space, experiments_of(data), fit.solver,
                                        opened.session().options.execution);
    REQUIRE(recorded.at("points").size() == 5);
    for (json const& point : recorded.at("points")) {
      double const ours = log_density(*target, point.at("values")), stan = point.at("log_density").get<double>();
      CAPTURE(ours);
      CAPTURE(stan);
      // Sums of thousands of terms in two orders, through thousands of steps; of exact ones two ways to the exponential of a
      // matrix, whose last digits add up in the phase.
      double const rounding = name.ends_with(", exact") ? 1e-11 : 1e-12;
      CHECK(std::fabs(ours - stan) <= rounding * std::fabs(stan));
    }
  }
}

TEST_CASE("what a Stan program cannot hold is refused by name") {
  CHECK(refusal("silverbox", read_file(models / "silverbox/silverbox.sysid"), "posterior") ==
        "`posterior` cannot be written as a Stan program: its start is estimated inside the likelihood");
  CHECK(refusal("robertson", read_file(models / "robertson/robertson.sysid"), "estimate") ==
        "`estimate` cannot be written as a Stan program: it is integrated by cvode");
  CHECK(refusal("bridge", read_file(models / "bridge/bridge.sysid"), "line_curved").find("is a Gaussian process over its rows") !=
        std::string::npos);
  CHECK(refusal("sir", read_file(models / "sir/sir.sysid"), "posterior").ends_with("it uses values of previous rows"));
}

TEST_CASE("names become identifiers of Stan, each its own") {
  std::vector<std::string> taken = {"h"};
  CHECK(stan_identifier("k3", taken) == "k3");
  CHECK(stan_identifier("joint.k", taken) == "joint_k");
  CHECK(stan_identifier("joint_k", taken) == "joint_k_1");
  CHECK(stan_identifier("M[1,2]", taken) == "M_1_2");
  CHECK(stan_identifier("h", taken) == "h_1");
  CHECK(stan_identifier("real", taken) == "real_1");
  CHECK(stan_identifier("y'", taken) == "y");
  CHECK(stan_identifier("__", taken) == "parameter_");
}

TEST_CASE("no name is a word of Stan or C++, a function of Stan's library or an ending of its distributions") {
  // The reference manual's types, blocks and statements; words of C++; functions that a model may well have as a parameter.
  for (char const* word : {"row_vector",
                           "unit_vector",
                           "cov_matrix",
                           "corr_matrix",
                           "cholesky_factor_corr",
                           "cholesky_factor_cov",
                           "simplex",
                           "ordered",
                           "positive_ordered",
                           "array",
                           "complex",
                           "complex_row_vector",
                           "tuple",
                           "jacobian",
                           "target",
                           "sum_to_zero_vector",
                           "column_stochastic_matrix",
                           "offset",
                           "multiplier",
                           "profile",
                           "lower",
                           "generated",
                           "int",
                           "while",
                           "fatal_error",
                           "STAN_MAJOR",
                           "constexpr",
                           "wchar_t",
                           "union",
                           "e",
                           "pi",
                           "mean",
                           "sd",
                           "step",
                           "rank",
                           "inv",
                           "segment",
                           "square",
                           "Phi",
                           "hypot",
                           "distance",
                           "choose",
                           "beta_lpdf",
                           "drag_log",
                           "noise_rng"}) {
    std::vector<std::string> taken;
    CHECK(stan_identifier(word, taken) == std::string(word) + "_1");
  }
  std::vector<std::string> taken;
  for (char const* name : {"k", "beta", "normal", "gain", "rate", "steps", "means", "Omega"})
    CHECK(stan_identifier(name, taken) == name);
}

TEST_CASE("numbers are reals of Stan") {
  CHECK(stan_real(2) == "2.0");
  CHECK(stan_real(-0.5) == "(-0.5)");
  CHECK(stan_real(5e10) == "50000000000.0");
  CHECK(stan_real(INFINITY) == "positive_infinity()");
}
