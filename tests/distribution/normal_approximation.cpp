// Mean and sd of the normal distributions that filters of moments take for other noises.
#include "distribution/normal_approximation.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace sysid;

TEST_CASE("the sd of log-normal noise is kept however small it is") {
  for (double const s : {1e-12, 1e-8, 1e-6, 0.3, 1.5}) {
    CAPTURE(s);
    Graph graph;
    Distribution noise;
    noise.row = find_distribution("log_normal");
    noise.arguments = {graph.constant(2.5), graph.constant(s)};
    Distribution const normal = normal_approximation(graph, noise);
    REQUIRE(normal.arguments.size() == 2);
    double const mean = graph.constant_value(normal.arguments[0]).value(), sd = graph.constant_value(normal.arguments[1]).value();
    CHECK(mean == doctest::Approx(2.5 * std::exp(s * s / 2)).epsilon(1e-13));
    CHECK(sd / s == doctest::Approx(2.5 * std::exp(s * s / 2) * std::sqrt(std::expm1(s * s)) / s).epsilon(1e-13));
  }
}
