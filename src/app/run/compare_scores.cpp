#include "app/run/compare_scores.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "criteria/model_weights.hpp"
#include "criteria/scores.hpp"
#include "report/file/number_table.hpp"
#include "report/file/stored_files.hpp"

namespace sysid {
namespace {

using json = nlohmann::json;

constexpr std::uint64_t bootstrap_seed = 0;  // the same weights for the same results

/// Which samples have a score under every fit.
std::vector<std::size_t> known_to_all(std::vector<ScoredFit const*> const& fits, std::vector<double> ScoredFit::*column) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < fits.front()->samples.size(); ++i)
    if (std::ranges::all_of(fits, [&](ScoredFit const* each) { return std::isfinite((each->*column)[i]); })) places.push_back(i);
  return places;
}

}  // namespace

std::optional<ScoredFit> scored_fit(std::string const& name, std::string const& model, std::filesystem::path const& folder,
                                    json const& summary) {
  std::filesystem::path const path = folder / "pointwise.csv";
  ScoredFit fit{name, model, false, 0, {}, {}, {}};
  bool const stored = interpreted(folder / "summary.json", [&] {
    if (!summary.at("versions").at("files").contains("pointwise.csv")) return false;
    fit.in_time = summary.at("criteria").at("in_time").get<bool>();
    return true;
  });
  if (!stored) return std::nullopt;
  NumberTable const table = read_number_table(path);
  auto const column = [&](char const* of) {
    std::vector<double> const* const found = table.find(of);
    if (found == nullptr) throw unusable_result(fmt::format("`{}` is damaged", path.string()));
    return *found;
  };
  std::vector<double> const series = column("series"), rows = column("row"), k = column("pareto_k");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    fit.samples.emplace_back(series[i], rows[i]);
    fit.doubtful += k[i] > largest_k ? 1 : 0;
  }
  fit.elpd_loo = column("elpd_loo");
  fit.elpd_future = column("elpd_future");
  return fit;
}

ComparedScores compare_scores(std::vector<ScoredFit> const& all) {
  std::vector<ScoredFit const*> fits;
  for (ScoredFit const& each : all)
    if (each.samples == all.front().samples) fits.push_back(&each);
  if (fits.size() < 2 || fits.front()->samples.size() < 2) return {};
  ComparedScores out;
  out.in_time = std::ranges::any_of(fits, [](ScoredFit const* each) { return each->in_time; });
  std::vector<double> ScoredFit::*column = &ScoredFit::elpd_future;
  std::vector<std::size_t> places = out.in_time ? known_to_all(fits, column) : std::vector<std::size_t>{};
  out.future = places.size() > 1;
  if (!out.future) places = known_to_all(fits, column = &ScoredFit::elpd_loo);
  if (places.size() < 2) return {};
  out.samples = static_cast<int>(places.size());
  PointwiseElpd elpd;
  for (ScoredFit const* each : fits) {
    elpd.emplace_back();
    for (std::size_t const i : places) elpd.back().push_back((each->*column)[i]);
  }
  std::vector<double> const stacking = stacking_weights(elpd), pseudo_bma = pseudo_bma_weights(elpd, bootstrap_seed);
  std::size_t best = 0;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    LogScore const score = sum_of(elpd[k]);
    out.fits.push_back(
        {fits[k]->name, fits[k]->model, score.sum, score.error, 0, 0, stacking[k], pseudo_bma[k], fits[k]->doubtful});
    if (score.sum > out.fits[best].elpd) best = k;
  }
  for (std::size_t k = 0; k < fits.size(); ++k) {
    ElpdDifference const from_best = elpd_difference(elpd[k], elpd[best]);
    out.fits[k].difference = from_best.sum;
    out.fits[k].difference_error = from_best.error;
  }
  return out;
}

}  // namespace sysid
