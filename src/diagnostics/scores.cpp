// Pointwise bands and scores.
#include "diagnostics/scores.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/statistics.hpp"
#include "diagnostics/residual_tests.hpp"

namespace sysid {

Band band(std::vector<std::vector<double>> const& trajectories) {
  // Samples that no draw can predict, because what they follow from was not measured, say nothing about a draw.
  std::vector<bool> predictable(trajectories.empty() ? 0 : trajectories.front().size(), false);
  for (std::vector<double> const& trajectory : trajectories)
    for (std::size_t i = 0; i < trajectory.size(); ++i) predictable[i] = predictable[i] || std::isfinite(trajectory[i]);
  bool const any = std::find(predictable.begin(), predictable.end(), true) != predictable.end();
  std::vector<std::vector<double> const*> usable;
  for (std::vector<double> const& trajectory : trajectories) {
    bool good = any;
    for (std::size_t i = 0; i < trajectory.size(); ++i) good = good && (std::isfinite(trajectory[i]) || !predictable[i]);
    if (good) usable.push_back(&trajectory);
  }
  Band out;
  out.draws = static_cast<int>(trajectories.size());
  out.excluded = static_cast<int>(trajectories.size() - usable.size());
  if (usable.empty()) return out;
  std::size_t const samples = usable[0]->size();
  std::vector<double> values(usable.size());
  for (std::size_t i = 0; i < samples; ++i) {
    if (!predictable[i]) {
      for (auto* column : {&out.mean, &out.sd, &out.lower, &out.upper}) column->push_back(std::nan(""));
      continue;
    }
    for (std::size_t d = 0; d < usable.size(); ++d) values[d] = (*usable[d])[i];
    out.mean.push_back(mean(values));
    out.sd.push_back(usable.size() > 1 ? std::sqrt(sample_variance(values)) : 0);
    out.lower.push_back(predictive_quantile(values, 0.025));
    out.upper.push_back(predictive_quantile(values, 0.975));
  }
  return out;
}

std::vector<Score> scores(PredictedQuantity const& quantity, std::vector<std::uint8_t> const& scored) {
  std::vector<std::size_t> rows;
  std::vector<double> observed, predicted;
  for (std::size_t i = 0; i < quantity.measured.size() && i < quantity.response.mean.size(); ++i) {
    if (scored[i] == 0 || !std::isfinite(quantity.measured[i]) || !std::isfinite(quantity.response.mean[i])) continue;
    rows.push_back(i);
    observed.push_back(quantity.measured[i]);
    predicted.push_back(quantity.response.mean[i]);
  }
  if (rows.empty()) return {};
  std::vector<Score> out = {{"nmse", nmse(observed, predicted)}, {"rmse", rmse(observed, predicted)}};
  if (quantity.noisy.mean.empty()) return out;
  double inside = 0, within = 0;
  auto const n = static_cast<double>(rows.size());
  for (std::size_t const i : rows) {
    double const y = quantity.measured[i];
    if (y >= quantity.noisy.lower[i] && y <= quantity.noisy.upper[i]) ++inside;
    if (std::fabs(y - quantity.noisy.mean[i]) <= 3 * quantity.noisy.sd[i]) ++within;
  }
  out.push_back({"coverage_95", inside / n});
  out.push_back({"coverage_3sd", within / n});
  return out;
}

std::vector<FitLine> fit_lines(Report const& report) {
  std::vector<FitLine> lines = report.fit;
  for (Prediction const& prediction : report.predictions)
    for (PredictedQuantity const& quantity : prediction.quantities) {
      std::vector<Score> const found = scores(quantity, prediction.scored);
      if (found.empty()) continue;
      auto line = std::find_if(lines.begin(), lines.end(), [&](FitLine const& each) {
        return each.experiment == prediction.experiment && each.channel == quantity.name;
      });
      if (line == lines.end()) line = lines.insert(line, {prediction.experiment, quantity.name, "", {}});
      line->unit = quantity.unit;
      for (Score const& score : found)
        if (std::none_of(line->scores.begin(), line->scores.end(), [&](Score const& other) { return other.name == score.name; }))
          line->scores.push_back(score);
    }
  return lines;
}

}  // namespace sysid
