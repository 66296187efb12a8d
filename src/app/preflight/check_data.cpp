// What a record holds for a task: rows, gaps, rate, and where the power of its inputs lies.
#include <algorithm>
#include <cmath>

#include "app/preflight/check_file.hpp"
#include "data/cell/usual_step.hpp"
#include "data/input_spectrum.hpp"

namespace sysid {

CoveragePage describe_coverage(ExperimentData const& data, DataBlock const& block, StartRule start, Model const& model) {
  Experiment const& experiment = data.experiment;
  CoveragePage page;
  page.name = experiment.name;
  page.file = block.mention();
  page.rows = data.record.rows();
  auto const first = std::find(experiment.scored.begin(), experiment.scored.end(), 1);
  page.first = experiment.first_row + static_cast<int>(first - experiment.scored.begin());
  page.last = experiment.first_row + static_cast<int>(experiment.scored.size()) - 1;
  page.scored = static_cast<int>(std::count(experiment.scored.begin(), experiment.scored.end(), 1));
  page.start_rows = start.kind == StartRule::Kind::estimated ? start.rows : 0;
  std::vector<double> const& time = experiment.time;
  double shortest = time.back() - time.front(), longest = 0;
  for (std::size_t i = 1; i < time.size(); ++i) {
    shortest = std::min(shortest, time[i] - time[i - 1]);
    longest = std::max(longest, time[i] - time[i - 1]);
  }
  page.timed = model.dynamics != Dynamics::none;
  bool const timed = model.dynamics != Dynamics::none && time.size() > 1;
  if (timed) {
    UsualStep const usual = usual_step(time);
    page.rate = 1 / usual.step;
    page.gaps = usual.gaps;
  }
  page.equal = longest - shortest <= 1e-3 * shortest;
  if (experiment.time_unit) {
    page.time_unit = experiment.time_unit->text;
    page.time_scale = experiment.time_unit->scale;
  }
  for (std::size_t i = 0; i < model.inputs.size(); ++i) {
    CoveragePage::Input input;
    input.name = model.inputs[i].name;
    input.unit = model.inputs[i].unit_text();
    if (model.dynamics == Dynamics::continuous) input.rule = rule_name(experiment.inputs[i].rule());
    if (timed) {
      InputSpectrum const spectrum = input_spectrum(experiment.inputs[i], page.rate);
      input.constant = spectrum.constant;
      input.low = spectrum.low;
      input.high = spectrum.high;
      input.top = spectrum.top;
      input.chords = spectrum.chords;
      input.cut_by_lines = cut_by_lines(spectrum);
    }
    page.inputs.push_back(std::move(input));
  }
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    CoveragePage::Channel channel;
    channel.name = model.channels[c].name;
    channel.unit = model.channels[c].unit_of_numbers();
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t i = 0; i < experiment.measured[c].size(); ++i) {
      if (experiment.scored[i] == 0) continue;
      double const value = experiment.measured[c][i];
      ++(std::isnan(value) ? channel.missing : channel.measured);
      if (std::isnan(value)) continue;
      least = std::min(least, value);
      most = std::max(most, value);
    }
    if (channel.measured > 0) channel.range = model.channels[c].from_si(most - least);
    page.channels.push_back(std::move(channel));
  }
  return page;
}

}  // namespace sysid
