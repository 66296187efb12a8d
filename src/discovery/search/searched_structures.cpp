// A set of terms is a support for each equation; those that the regression knows are its own.
#include "discovery/search/searched_structures.hpp"

#include <algorithm>
#include <utility>

#include "core/numeric/elementary.hpp"

namespace sysid {
namespace {

regression::Support support_of(WholeDictionary const& dictionary, SearchedTerms const& searched, std::size_t equation) {
  regression::Support support;
  std::vector<Eigen::Index> rows;
  for (std::size_t i = 0; i < searched.terms.size(); ++i) {
    WholeDictionary::Column const& column = dictionary.columns()[static_cast<std::size_t>(searched.terms[i])];
    if (column.equation != equation) continue;
    support.terms.push_back(static_cast<int>(column.term));
    rows.push_back(static_cast<Eigen::Index>(i));
  }
  auto const count = static_cast<Eigen::Index>(rows.size());
  support.coefficient.resize(count);
  support.covariance = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    support.coefficient(i) = searched.coefficients(rows[static_cast<std::size_t>(i)]);
    for (Eigen::Index j = 0; j < count && searched.covariance.size() > 0; ++j)
      support.covariance(i, j) = searched.covariance(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
  }
  return support;
}

regression::Support const* listed_by(regression::FoundEquation const& equation, std::vector<int> const& terms) {
  if (equation.chosen.terms == terms) return &equation.chosen;
  auto const found = std::find_if(equation.supports.begin(), equation.supports.end(),
                                  [&](regression::Support const& each) { return each.terms == terms; });
  return found == equation.supports.end() ? nullptr : &*found;
}

}  // namespace

StructureSearch searched_structures(FoundSource const& source, WholeDictionary const& dictionary, std::vector<SearchedTerms> all,
                                    std::vector<FoundStructure> const& listed, int most) {
  StructureSearch out;
  out.searched = true;
  std::stable_sort(all.begin(), all.end(), [](SearchedTerms const& a, SearchedTerms const& b) { return a.score > b.score; });
  std::vector<Terms> listed_terms;
  for (FoundStructure const& each : listed) listed_terms.push_back(dictionary.terms_of(each));
  auto const structure_of = [&](SearchedTerms const& each) {
    FoundStructure structure;
    for (std::size_t e = 0; e < source.dictionary.equations.size(); ++e) {
      regression::Support support = support_of(dictionary, each, e);
      structure.refined.push_back(support.coefficient);
      regression::Support const* known = listed_by(source.discovery.equations[e], support.terms);
      if (known == nullptr) known = &out.supports.emplace_back(std::move(support));
      structure.equations.push_back(known);
    }
    for (std::size_t m = 0; m < listed.size() && structure.of_regression == 0; ++m)
      if (listed_terms[m] == each.terms) structure.of_regression = static_cast<int>(m) + 1;
    structure.score = each.score;
    return structure;
  };
  bool chosen = false;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (out.structures.size() < static_cast<std::size_t>(most)) {
      out.structures.push_back(structure_of(all[i]));
      chosen = chosen || out.structures.back().of_regression == 1;
    } else {
      out.record.others += elementary::exp(all[i].score - all.front().score);
    }
  }
  if (!chosen) {
    out.structures.push_back(listed.front());
    out.structures.back().of_regression = 1;
  }
  return out;
}

void describe_record(WholeDictionary const& dictionary, FitConditions const& conditions, RecordLimits const& limits,
                     std::size_t channels, SearchedRecord& record) {
  record.noise.floor.assign(channels, 0);
  record.growth.assign(channels, 0);
  record.substeps = conditions.substeps;
  for (std::size_t e = 0; e < conditions.noise.relative.size(); ++e)
    record.noise.relative.emplace_back(channels, std::vector<double>(dictionary.records()[e].time.size(), 1.0));
  std::vector<std::size_t> const& own = dictionary.model().channels;
  for (std::size_t c = 0; c < own.size(); ++c) {
    record.noise.floor[own[c]] = conditions.noise.floor[c];
    record.growth[own[c]] = limits.growth(c);
    for (std::size_t e = 0; e < record.noise.relative.size(); ++e)
      record.noise.relative[e][own[c]] = conditions.noise.relative[e][c];
  }
  if (!conditions.noise.carried) return;
  auto carried = std::make_shared<std::vector<CarriedErrors>>(*conditions.noise.carried);
  for (std::size_t e = 0; e < carried->size(); ++e) {
    CarriedErrors const& of = (*conditions.noise.carried)[e];
    CarriedErrors& each = (*carried)[e];
    each.state_of_channel.assign(channels, -1);
    each.own_sd.assign(channels, std::vector<double>(of.input_sd.size(), 1.0));
    for (std::size_t c = 0; c < own.size(); ++c) {
      each.state_of_channel[own[c]] = of.state_of_channel[c];
      each.own_sd[own[c]] = of.own_sd[c];
    }
  }
  record.noise.carried = std::move(carried);
}

}  // namespace sysid
