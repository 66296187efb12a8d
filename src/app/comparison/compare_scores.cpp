#include "app/comparison/compare_scores.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <tuple>

#include "core/numeric/not_finite.hpp"
#include "criteria/model_weights.hpp"
#include "criteria/scores.hpp"
#include "report/file/number_table.hpp"
#include "report/file/stored_files.hpp"

namespace sysid {
namespace {

using json = nlohmann::json;

constexpr std::uint64_t bootstrap_seed = 0;  // the same weights for the same results

/// Which samples have a score under every fit; -infinity is one, of a fit that says that they cannot be.
std::vector<std::size_t> known_to_all(std::vector<ScoredFit const*> const& fits, std::vector<double> ScoredFit::*column) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < fits.front()->samples.size(); ++i)
    if (std::ranges::all_of(fits, [&](ScoredFit const* each) { return !std::isnan((each->*column)[i]); })) places.push_back(i);
  return places;
}

/// Of the models that give each sample some density, each by its first fit; no weight to others. identities: of the fits.
void weigh(PointwiseElpd const& elpd, std::vector<std::string> const& identities, std::vector<ComparedScore>& fits) {
  PointwiseElpd weighed;
  std::vector<std::size_t> places;
  std::map<std::string, std::size_t> standing;  // fit of a model
  for (std::size_t k = 0; k < fits.size(); ++k)
    if (fits[k].impossible == 0 && standing.emplace(identities[k], k).second) {
      places.push_back(k);
      weighed.push_back(elpd[k]);
    }
  if (places.empty()) return;
  bool const one = places.size() == 1;
  std::vector<double> const alone = {1}, stacking = one ? alone : stacking_weights(weighed),
                            pseudo_bma = one ? alone : pseudo_bma_weights(weighed, bootstrap_seed);
  for (std::size_t p = 0; p < places.size(); ++p) {
    fits[places[p]].stacking = stacking[p];
    fits[places[p]].pseudo_bma = pseudo_bma[p];
  }
  for (std::size_t k = 0; k < fits.size(); ++k)
    if (auto const of = standing.find(identities[k]); fits[k].impossible == 0 && of != standing.end()) {
      fits[k].stacking = fits[of->second].stacking;
      fits[k].pseudo_bma = fits[of->second].pseudo_bma;
      if (of->second != k) fits[k].counted = fits[of->second].name;
    }
}

struct Series {
  std::string channel;
  int experiment = 0;
};

/// The series that the comments name, `channel on experiment`. Those of an experiment stand together, each channel once.
std::vector<Series> series_of(NumberTable const& table) {
  std::vector<Series> all;
  std::set<std::string> channels;  // of the experiment
  std::string last;
  int experiment = -1;
  while (true) {
    auto const named = table.head.find(fmt::format("series {}", all.size() + 1));
    std::size_t const on = named == table.head.end() ? std::string::npos : named->second.find(" on ");
    if (on == std::string::npos) return all;
    std::string channel = named->second.substr(0, on), name = named->second.substr(on + 4);
    if (experiment < 0 || name != last || channels.contains(channel)) {
      ++experiment;
      channels.clear();
      last = std::move(name);
    }
    channels.insert(channel);
    all.push_back({std::move(channel), experiment});
  }
}

/// The experiments of a result by the digests of their samples: fits may name the same ones in any order.
std::vector<int> places_of(json const& summary) {
  std::vector<std::string> digests;
  for (json const& data : summary.at("data")) digests.push_back(data.value("samples_sha256", ""));
  std::vector<std::size_t> order(digests.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t e) { return digests[e]; });
  std::vector<int> places(digests.size());
  for (std::size_t k = 0; k < order.size(); ++k) places[order[k]] = static_cast<int>(k);
  return places;
}

}  // namespace

std::optional<ScoredFit> scored_fit(std::string const& name, std::string const& model, std::filesystem::path const& folder,
                                    json const& summary) {
  std::filesystem::path const path = folder / "pointwise.csv";
  ScoredFit fit;
  fit.name = name;
  fit.model = model;
  bool const stored = interpreted(folder / "summary.json", [&] {
    if (!summary.at("versions").at("files").contains("pointwise.csv")) return false;
    fit.in_time = summary.at("criteria").at("in_time").get<bool>();
    fit.draws = summary.at("criteria").at("draws").get<int>();
    fit.one_step = summary.value("measured_past", false);
    return true;
  });
  if (!stored) return std::nullopt;
  NumberTable const table = read_number_table(path);
  auto const damaged = [&] { return unusable_result(fmt::format("`{}` is damaged", path.string())); };
  auto const column = [&](char const* of) {
    std::vector<double> const* const found = table.find(of);
    if (found == nullptr) throw damaged();
    return *found;
  };
  std::vector<double> const series = column("series"), rows = column("row"), k = column("pareto_k"), loo = column("elpd_loo"),
                            future = column("elpd_future");
  std::vector<Series> const names = series_of(table);
  std::vector<int> const places = places_of(summary);
  auto const place_of = [&](int experiment) {  // of a result with all experiments, as all but old ones are
    return static_cast<std::size_t>(experiment) < places.size() ? places[static_cast<std::size_t>(experiment)] : experiment;
  };
  std::vector<ScoredSample> samples;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!(series[i] >= 1 && series[i] <= static_cast<double>(names.size()))) throw damaged();
    Series const& of = names[static_cast<std::size_t>(series[i]) - 1];
    samples.push_back({of.channel, place_of(of.experiment), static_cast<int>(rows[i])});
    fit.doubtful += k[i] > largest_k(fit.draws) ? 1 : 0;
  }
  std::vector<std::size_t> order(samples.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return std::tie(samples[i].channel, samples[i].experiment, samples[i].row); });
  for (std::size_t const i : order) {
    fit.samples.push_back(std::move(samples[i]));
    fit.elpd_loo.push_back(loo[i]);
    fit.elpd_future.push_back(future[i]);
  }
  return fit;
}

ComparedScores compare_scores(std::vector<ScoredFit> const& all) {
  ComparedScores out;
  std::vector<ScoredFit const*> fits;
  for (ScoredFit const& each : all)
    if (each.samples == all.front().samples)
      fits.push_back(&each);
    else
      out.left_out.push_back(each.name);
  if (fits.size() < 2 || fits.front()->samples.size() < 2) return out;
  out.in_time = std::ranges::any_of(fits, [](ScoredFit const* each) { return each->in_time; });
  std::vector<double> ScoredFit::*column = &ScoredFit::elpd_future;
  std::vector<std::size_t> places = out.in_time ? known_to_all(fits, column) : std::vector<std::size_t>{};
  out.future = places.size() > 1;
  if (!out.future) places = known_to_all(fits, column = &ScoredFit::elpd_loo);
  if (places.size() < 2) return out;
  out.samples = static_cast<int>(places.size());
  PointwiseElpd elpd;
  for (ScoredFit const* each : fits) {
    elpd.emplace_back();
    for (std::size_t const i : places) elpd.back().push_back((each->*column)[i]);
  }
  std::size_t best = 0;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    LogScore const score = sum_of(elpd[k]);
    ComparedScore fit{fits[k]->name, fits[k]->model, score.sum, score.error};
    fit.doubtful = fits[k]->doubtful;
    fit.one_step = fits[k]->one_step;
    fit.impossible = static_cast<int>(std::ranges::count(elpd[k], -infinity));
    out.fits.push_back(std::move(fit));
    if (score.sum > out.fits[best].elpd) best = k;
  }
  for (std::size_t k = 0; k < fits.size(); ++k) {
    ElpdDifference const from_best = elpd_difference(elpd[k], elpd[best]);
    out.fits[k].difference = from_best.sum;
    out.fits[k].difference_error = from_best.error;
  }
  std::vector<std::string> identities;
  for (ScoredFit const* each : fits) identities.push_back(each->identity);
  weigh(elpd, identities, out.fits);
  return out;
}

}  // namespace sysid
