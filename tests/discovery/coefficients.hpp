// Coefficients that a discovery fitted by simulation, against the true ones.
#pragma once
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sysid::test {

/// Of one structure: each within four of its sds, and within a share of its true value.
inline void check_coefficients(nlohmann::json const& structure, std::vector<double> const& true_values, double within) {
  REQUIRE(structure.at("coefficients").size() == true_values.size());
  for (std::size_t j = 0; j < true_values.size(); ++j) {
    nlohmann::json const& each = structure.at("coefficients").at(j);
    CAPTURE(each.at("term").get<std::string>());
    double const value = each.at("value"), sd = each.at("sd");
    CHECK(std::abs(value - true_values[j]) < 4 * sd);
    CHECK(std::abs(value / true_values[j] - 1) < within);
  }
}

}  // namespace sysid::test
