// Supports with rows taken out.
#include "discovery/idle_terms.hpp"

#include <algorithm>
#include <cmath>

namespace sysid {
namespace {

constexpr std::size_t first_structures = 3;
constexpr double idle_sds = 3;

struct IdleTerm {
  std::size_t equation, row;
};

regression::Support without(regression::Support const& support, std::vector<std::size_t> const& rows) {
  regression::Support out = support;
  std::vector<Eigen::Index> kept;
  out.terms.clear();
  for (std::size_t i = 0; i < support.terms.size(); ++i) {
    if (std::find(rows.begin(), rows.end(), i) != rows.end()) continue;
    out.terms.push_back(support.terms[i]);
    kept.push_back(static_cast<Eigen::Index>(i));
  }
  auto const count = static_cast<Eigen::Index>(kept.size());
  out.coefficient.resize(count);
  out.covariance.resize(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    auto const from = kept[static_cast<std::size_t>(i)];
    out.coefficient(i) = support.coefficient(from);
    for (Eigen::Index j = 0; j < count; ++j) out.covariance(i, j) = support.covariance(from, kept[static_cast<std::size_t>(j)]);
  }
  return out;
}

FoundStructure without(FoundStructure const& structure, std::vector<IdleTerm> const& places,
                       std::deque<regression::Support>& supports) {
  FoundStructure out = structure;
  out.refined.clear();
  out.of_regression = 0;
  for (std::size_t e = 0; e < out.equations.size(); ++e) {
    std::vector<std::size_t> rows;
    for (IdleTerm const& each : places)
      if (each.equation == e) rows.push_back(each.row);
    if (rows.empty()) continue;
    supports.push_back(without(*structure.equations[e], rows));
    out.equations[e] = &supports.back();
  }
  return out;
}

}  // namespace

std::vector<FoundStructure> without_idle_terms(CheckedDictionary const& dictionary, Validation const& validation,
                                               std::deque<regression::Support>& supports) {
  std::vector<FoundStructure> out;
  for (std::size_t k = 0; k < std::min(first_structures, validation.order.size()); ++k) {
    ValidatedStructure const& fitted = validation.report.structures[k];
    FoundStructure const& structure = validation.order[k];
    if (!fitted.failure.empty()) continue;
    std::vector<IdleTerm> idle;
    std::size_t coefficient = 0;  // they stand equation by equation
    for (std::size_t e = 0; e < structure.equations.size(); ++e)
      for (std::size_t i = 0; i < structure.equations[e]->terms.size(); ++i, ++coefficient) {
        ValidatedCoefficient const& each = fitted.coefficients[coefficient];
        auto const term = static_cast<std::size_t>(structure.equations[e]->terms[i]);
        if (!dictionary.equations[e].terms[term].in_target && std::abs(each.value) < idle_sds * each.sd) idle.push_back({e, i});
      }
    for (IdleTerm const& each : idle) out.push_back(without(structure, {each}, supports));
    if (idle.size() > 1) out.push_back(without(structure, idle, supports));
  }
  return out;
}

}  // namespace sysid
