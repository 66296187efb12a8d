// An experiment takes a part of the rows of a record, and keeps the samples before them as its history.
#include "data/record_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "data/input_gap.hpp"
#include "data/table/file_errors.hpp"

namespace sysid {

std::optional<Diagnostic> check_rows(Record const& record, std::string const& what, RowRange rows, std::optional<Span> mention) {
  int const last = rows.last == 0 ? record.rows() : rows.last;
  if (rows.first >= 1 && rows.first <= last && last <= record.rows()) return std::nullopt;
  return data_errors::rows_outside(record.path, what, rows.first, last, record.rows(), mention);
}

Experiment make_experiment(Record const& record, std::string name, int simulate_from, RowRange scored, std::optional<Span> mention,
                           int earlier) {
  if (std::optional<Diagnostic> wrong = check_rows(record, fmt::format("`{}`", name), scored, mention))
    throw UserError(std::move(*wrong));
  if (simulate_from < 1 || simulate_from > scored.first)
    throw InternalError("a simulation starts after the first row it is scored on");
  int const last = scored.last == 0 ? record.rows() : scored.last;
  int const begin = simulate_from - 1;
  refuse_gaps(record, {simulate_from - earlier, last}, {simulate_from, last});
  Experiment experiment;
  experiment.name = std::move(name);
  experiment.first_row = simulate_from;
  experiment.time_unit = record.time_unit;
  experiment.time.assign(record.time.begin() + begin, record.time.begin() + last);
  for (InputSignal const& input : record.inputs) experiment.inputs.push_back(input.view(begin, last - begin));
  for (std::vector<double> const& channel : record.measured) {
    if (channel.empty())
      experiment.measured.emplace_back();
    else
      experiment.measured.emplace_back(channel.begin() + begin, channel.begin() + last);
    std::vector<double> before(channel.begin(), channel.begin() + (channel.empty() ? 0 : begin));
    std::reverse(before.begin(), before.end());
    experiment.history.push_back(std::move(before));
  }
  experiment.scored.assign(static_cast<std::size_t>(last - begin), 0);
  std::fill(experiment.scored.begin() + (scored.first - simulate_from), experiment.scored.end(), std::uint8_t{1});
  return experiment;
}

}  // namespace sysid
