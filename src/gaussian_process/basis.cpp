// Products of sines over the inputs by the recurrence for multiple angles, weighted by the spectral density of the kernel.
#include "gaussian_process/basis.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "function/primitive.hpp"

namespace sysid::gaussian_process {

Basis::Basis(Box box) : box_(std::move(box)) {
  int const size = std::accumulate(box_.counts.begin(), box_.counts.end(), 1, std::multiplies<>());
  frequencies_.assign(static_cast<std::size_t>(size), std::vector<double>(box_.counts.size()));
  for (int j = 0; j < size; ++j) {
    int rest = j;
    for (std::size_t d = box_.counts.size(); d-- > 0;) {
      frequencies_[static_cast<std::size_t>(j)][d] = std::numbers::pi * (rest % box_.counts[d] + 1) / (2 * box_.half_widths[d]);
      rest /= box_.counts[d];
    }
  }
}

Term Basis::sum(std::vector<std::vector<Term>> const& sines, std::size_t input, std::span<NodeId const>& weights) const {
  Graph& graph = *sines.front().front().graph;
  std::optional<Term> total;
  for (Term const sine : sines[input]) {
    bool const last = input + 1 == sines.size();
    Term const factor = last ? Term(graph, weights.front()) : sum(sines, input + 1, weights);
    if (last) weights = weights.subspan(1);
    total = total ? *total + factor * sine : factor * sine;
  }
  return *total;
}

NodeId Basis::sum(Graph& graph, std::span<NodeId const> inputs, std::span<NodeId const> weights) const {
  std::vector<std::vector<Term>> sines;
  for (std::size_t d = 0; d < inputs.size(); ++d) {
    double const half = box_.half_widths[d];
    Term const angle = std::numbers::pi / (2 * half) * (Term(graph, inputs[d]) - (box_.centre[d] - half)), twice = 2.0 * cos(angle);
    // sin((j + 1) a) = 2 cos(a) sin(j a) - sin((j - 1) a)
    Term before(graph, 0.0), sine = 1 / std::sqrt(half) * sin(angle);
    sines.emplace_back();
    for (int j = 0; j < box_.counts[d]; ++j) {
      sines.back().push_back(sine);
      before = std::exchange(sine, twice * sine - before);
    }
  }
  return sum(sines, 0, weights).id;
}

bool has_expansion(KernelRow const& row) { return row.spectral_root != nullptr || row.features != nullptr; }

int expansion_size(KernelRow const& row, std::vector<int> const& counts) {
  if (row.features != nullptr) return hyper_parameter_count(row, static_cast<int>(counts.size()));
  return std::accumulate(counts.begin(), counts.end(), 1, std::multiplies<>());
}

NodeId expansion(KernelRow const& row, Graph& graph, std::span<NodeId const> parameters, std::span<NodeId const> inputs,
                 std::span<NodeId const> coefficients, Box const& box) {
  if (row.features != nullptr) {
    Term sum(graph, 0.0);
    std::vector<NodeId> const features = row.features(graph, parameters, inputs);
    for (std::size_t j = 0; j < features.size(); ++j) sum = sum + Term(graph, coefficients[j]) * Term(graph, features[j]);
    return sum.id;
  }
  Basis const basis(box);
  std::vector<NodeId> weights;
  for (int j = 0; j < basis.size(); ++j)
    weights.push_back(
        graph.multiply(row.spectral_root(graph, parameters, basis.frequencies(j)), coefficients[static_cast<std::size_t>(j)]));
  return basis.sum(graph, inputs, weights);
}

}  // namespace sysid::gaussian_process
