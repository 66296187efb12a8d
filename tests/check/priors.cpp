// Hierarchies of priors: the order of drawing, cycles, what a prior may read.
#include <algorithm>

#include "checking.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

Model with_parameters(std::string const& parameters) { return model_of(parameters + "\nobserve c ~ normal(a, sd = 1)"); }
std::string refused_parameters(std::string const& parameters) {
  return messages("model m {\n" + parameters + "\nobserve c ~ normal(a, sd = 1)\n}\n");
}

// Position of a parameter in the order of drawing.
std::ptrdiff_t place(Model const& model, std::string const& name) {
  auto const parameter =
      std::find_if(model.parameters.begin(), model.parameters.end(), [&](Parameter const& each) { return each.name == name; });
  auto const index = static_cast<int>(parameter - model.parameters.begin());
  return std::find(model.sampling_order.begin(), model.sampling_order.end(), index) - model.sampling_order.begin();
}

}  // namespace

TEST_CASE("parameters are drawn after those their priors read, also through definitions") {
  Model const model = with_parameters(
      "parameter a ~ normal(b, sd = spread)\nlet spread = 2*s\nparameter b ~ normal(0, sd = s)\nparameter s ~ half_normal(sd = f)\n"
      "parameter f = 3");
  REQUIRE(model.sampling_order.size() == 3);
  CHECK(place(model, "s") < place(model, "b"));
  CHECK(place(model, "b") < place(model, "a"));
  CHECK(model.parameters[0].name == "a");  // reports keep the user's order
}

TEST_CASE("bounds count as what a prior reads") {
  Model const model = with_parameters("parameter a ~ normal(0, sd = 1, lower = b)\nparameter b ~ normal(0, sd = 1)");
  CHECK(place(model, "b") < place(model, "a"));
  CHECK(at(model, model.parameters[0].prior->lower.value(), {{"b", 0.25}}) == 0.25);
}

TEST_CASE("priors that need each other are refused with the loop written out") {
  std::string const shown = refused_parameters(
      "parameter a ~ normal(b, sd = 1)\nparameter b ~ normal(0, sd = 1, upper = c)\nparameter c ~ normal(a, sd = 1)");
  CHECK(errors_in(shown) == 1);
  CHECK(shown.find("error[E2111]: these priors depend on each other in a cycle: a -> b -> c -> a") != std::string::npos);
  CHECK(errors_in(refused_parameters("parameter a ~ normal(a, sd = 1)")) == 1);
}

TEST_CASE("a prior may not read what moves") {
  for (char const* moving : {"x", "t", "y"}) {
    CAPTURE(moving);
    std::string const shown = refused_parameters(
        std::string("input x\ntime t\nstate y\ninitial y = 0\ny' = a\nparameter a ~ normal(") + moving + ", sd = 1)");
    CHECK(errors_in(shown) == 1);
    CHECK(shown.find("error[E2110]") != std::string::npos);
  }
}

TEST_CASE("one spelling of a width is wanted, and is named") {
  CHECK(refused_parameters("parameter a ~ normal(0, sd = 1, precision = 1)")
            .find("`sd` and `precision` are two forms of the same argument") != std::string::npos);
  CHECK(refused_parameters("parameter a ~ normal(0, 1)")
            .find("error[E2106]: the name of this argument is missing: `sd`, `variance` or `precision`") != std::string::npos);
  CHECK(refused_parameters("parameter a ~ normal(0, precison = 1)").find("help: did you mean `precision`?") != std::string::npos);
  CHECK(refused_parameters("parameter a ~ normal(mean = 0, mean = 1, sd = 1)").find("`mean` is given twice") != std::string::npos);
}

TEST_CASE("impossible numbers are refused before the run") {
  for (char const* call : {"normal(0, sd = -1)", "normal(0, sd = 0)", "uniform(2, 1)", "log_uniform(0, 1)", "gamma(-1, rate = 1)",
                           "normal(0, sd = 1, lower = 2, upper = 1)"}) {
    CAPTURE(call);
    std::string const shown = refused_parameters(std::string("parameter a ~ ") + call);
    CHECK(errors_in(shown) == 1);
    CHECK(shown.find("error[E2112]") != std::string::npos);
  }
}

TEST_CASE("bounds that leave nothing are refused before the run, those that leave a tail are not") {
  for (char const* call :
       {"normal(0, sd = 1, lower = 50)", "log_normal(1, sd = 1, upper = -1)", "exponential(mean = 1, upper = 0)"}) {
    CAPTURE(call);
    CHECK(refused_parameters(std::string("parameter a ~ ") + call).find("error[E2115]") != std::string::npos);
  }
  for (char const* call : {"normal(0, sd = 1, lower = 30)", "exponential(mean = 1, lower = 0.5)", "flat(lower = 0)"}) {
    CAPTURE(call);
    CHECK(refused_parameters(std::string("parameter a ~ ") + call).empty());
  }
}

TEST_CASE("a share has no unit but those of pure numbers") {
  CHECK(refused_parameters("parameter a [m] ~ beta(2, 2)").find("error[E2117]") != std::string::npos);
  CHECK(refused_parameters("parameter a [percent] ~ beta(2, 2)").empty());
  CHECK(refused_parameters("parameter a ~ beta(2, 2)").empty());
}

TEST_CASE("a width that some value of the priors makes positive is left to the run") {
  auto const refused_parameters = [](std::string const& prior, std::string const& width) {
    std::string const said = messages("model line {\n  input x\n  parameter b ~ half_normal(sd = 1)\n  parameter s ~ " + prior +
                                      "\n  observe y ~ normal(b*x, " + width + ")\n}\n");
    bool const impossible = said.find("error[E2112]") != std::string::npos;
    CHECK_MESSAGE(impossible == (said.find("error") != std::string::npos), said);
    return impossible;
  };
  for (char const* width : {"sd = s", "sd = 2*s/3", "variance = s", "precision = s", "sd = s - b", "sd = min(s, b)", "sd = 1/s"}) {
    CAPTURE(width);
    CHECK(refused_parameters("uniform(-2, -1)", width));
    CHECK(refused_parameters("uniform(-2, 0)", width));
    CHECK(refused_parameters("normal(-9, sd = 0.1, upper = -b)", width));
    CHECK(!refused_parameters("uniform(-2, 0.1)", width));
    CHECK(!refused_parameters("normal(-9, sd = 0.1)", width));
  }
  for (char const* width :
       {"sd = -s", "sd = abs(s)", "sd = s^2", "sd = s*s", "sd = sqrt(-s)", "sd = exp(s)", "sd = max(s, b)", "sd = s + b"})
    CHECK(!refused_parameters("uniform(-2, -1)", width));
}

TEST_CASE("log_mean and log_sd are a median and a sd, and a logarithm by position is asked about") {
  auto const said = [](std::string const& prior) {
    return test::messages("model m {\nparameter k [N/mm] ~ " + prior + "\nobserve d [N/mm] ~ normal(k, sd = 1)\n}\n");
  };
  CHECK(said("log_normal(log_mean = log(30), log_sd = 0.5)") == "");
  CHECK(said("log_normal(30, sd = 0.5)") == "");
  CHECK(said("log_normal(median = log(30), sd = 0.5)") == "");
  CHECK(said("log_normal(log(30), sd = 0.5)").find("`median = 30` if `log(30)` is the mean of the logarithm") != std::string::npos);
  CHECK(said("log_normal(log_mean = 3, median = 30, sd = 0.5)").find("E2104") != std::string::npos);
  CHECK(said("log_normal(mean = log(30), sd = 0.5)").find("did you mean") == std::string::npos);
  CHECK(said("log_normal(mean = log(30), sd = 0.5)").find("log_mean") != std::string::npos);
}

TEST_CASE("a decimal comma among arguments is named, a list of whole numbers is one") {
  auto const said = [](std::string const& prior) {
    return test::messages("model m {\nparameter k ~ " + prior + "\nobserve d ~ normal(k, sd = 1)\n}\n");
  };
  CHECK(said("log_uniform(0,5, 200)").find("`0.5`") != std::string::npos);
  CHECK(said("log_uniform(0,05, 200)").find("`0.05`") != std::string::npos);
  CHECK(said("normal(2,5, sd = 1)").find("`2.5`") != std::string::npos);
  CHECK(said("uniform(0,5)") == "");
  CHECK(said("uniform(0, 5, 200)").find("decimal point") == std::string::npos);
}

TEST_CASE("degrees of freedom before the location are told by what cannot count them") {
  std::string const mean = "parameter mu [m] ~ normal(0, sd = 1)\n", count = "parameter nu ~ log_uniform(1, 100)\n";
  for (auto const& [prior, whole] : {std::pair("a ~ student_t(3, 0, scale = 10)", "`student_t(0, 3, scale = 10)`"),
                                     {"a ~ student_t(3, -1, 10)", "`student_t(-1, 3, scale = 10)`"},
                                     {"a [m] ~ student_t(3, mu, sd = 2)", "`student_t(mu, 3, sd = 2)`"}}) {
    CAPTURE(prior);
    std::string const said = refused_parameters(mean + "parameter " + prior);
    CHECK(errors_in(said) == 1);
    CHECK(said.find("error[E2106]: the location of `student_t` comes first") != std::string::npos);
    CHECK(said.find(std::string("help: write ") + whole) != std::string::npos);
  }
  for (char const* prior : {"student_t(0, 3, scale = 10)", "student_t(4, 20, scale = 5)", "student_t(0, nu, scale = 1)",
                            "student_t(2, nu, scale = 1)", "student_t(nu, 4, scale = 1)"})
    CHECK(errors_in(refused_parameters(count + "parameter a ~ " + prior)) == 0);
}

TEST_CASE("a location of a distribution that begins at 0 is too many, and what is left is written out") {
  std::string const said = refused_parameters("parameter a ~ half_cauchy(0, 5, upper = 9)");
  CHECK(errors_in(said) == 1);
  CHECK(said.find("error[E2107]: `half_cauchy` begins at 0 and takes no location") != std::string::npos);
  CHECK(said.find("`half_cauchy(5, upper = 9)`") != std::string::npos);
  CHECK(errors_in(refused_parameters("parameter a ~ half_cauchy(5, upper = 9)")) == 0);
}

TEST_CASE("a log-normal distribution of other languages is offered with its first number as a median too") {
  auto const help = [](std::string const& call) { return refused_parameters("parameter a ~ " + call); };
  std::string const large = help("lognormal(300, 0.5)"), small = help("lognormal(5.8, 0.5)"), below = help("lognormal(-2, 0.5)");
  CHECK(large.find("median = 300") < large.find("log_mean = 300"));
  CHECK(small.find("log_mean = 5.8") < small.find("median = 5.8"));
  CHECK(small.find("median = 5.8") != std::string::npos);
  CHECK(below.find("median") == std::string::npos);
  CHECK(help("lognormal(mu = 5.8, sigma = 0.5)").find("median =") == std::string::npos);
}

TEST_CASE("an argument that is computed from one that is missing or wrong is left alone") {
  std::string const noise = "parameter sigma ~ half_normal(sd = 1)\nparameter a ~ ";
  for (auto const& [prior, code] : {std::pair("gamma(mean = 0.03)", "E2105"),
                                    {"gamma(mean = 0.03, variance = 0.01)", "E2102"},
                                    {"gamma(mean = 0.03, rate = 1)", "E2104"},
                                    {"gamma(shapes, mean = 0.03)", "E2001"},
                                    {"gamma(\"2\", mean = 0.03)", "E2009"},
                                    {"gamma((1, 2), mean = 0.03)", "E2013"},
                                    {"student_t(0, sd = sigma)", "E2105"},
                                    {"student_t(0, variance = sigma)", "E2105"},
                                    {"student_t(0, nu, precision = sigma)", "E2001"},
                                    {"student_t(b, 4, sd = sigma)", "E2001"}}) {
    CAPTURE(prior);
    std::string const said = refused_parameters(noise + prior);
    CHECK(errors_in(said) == 1);
    CHECK(said.find(std::string("error[") + code + "]") != std::string::npos);
  }
}

TEST_CASE("a width whose prior reaches below zero is warned of, whatever bounds it") {
  auto const said = [](std::string const& prior) {
    return messages("model m {\nstate y\ninitial y = 1\nparameter a ~ uniform(0, 1)\nparameter s ~ " + prior +
                    "\ny' = -a*y\nobserve d ~ normal(y, sd = s)\n}\n");
  };
  for (char const* const wrong : {"normal(0, sd = 1)", "uniform(-1, 1)", "normal(0, sd = 1, lower = -5)",
                                  "student_t(0, 3, scale = 4)", "normal(1, sd = 1)"}) {
    CAPTURE(wrong);
    CHECK(said(wrong).find("warning[E2120]") != std::string::npos);
  }
  for (char const* const right : {"half_normal(sd = 1)", "uniform(0, 1)", "normal(0, sd = 1, lower = 0)", "normal(1, sd = 0.1)",
                                  "log_normal(median = 1, sd = 1)", "gamma(2, mean = 1)", "exponential(mean = 1)", "log_flat()"}) {
    CAPTURE(right);
    CHECK(said(right).empty());
  }
}
