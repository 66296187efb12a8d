// A gap outside the rows of a run changes nothing in it, up to what a spline or a window reads around an interval.
#include "data/input_gap.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "data/table/cell_errors.hpp"

namespace sysid {
namespace {

/// The longest run of rows within `rows` in which the input of `gap` has no gap; last = 0: none of two rows.
RowRange longest_without_gap(std::span<InputGap const> gaps, InputGap const& gap, RowRange rows, int around) {
  RowRange best{1, 0};
  int from = rows.first;
  auto const end_at = [&](int last) {
    if (last - from > std::max(best.last - best.first, 0)) best = {from, last};
  };
  for (InputGap const& each : gaps) {
    if (each.input != gap.input || each.last + around < rows.first || each.first - around > rows.last) continue;
    end_at(each.first - 1 - around);
    from = each.last + 1 + around;
  }
  end_at(rows.last);
  return best;
}

}  // namespace

std::vector<InputGap> bridge_gaps(std::vector<double>& values) {
  std::vector<InputGap> gaps;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isnan(values[i])) continue;
    std::size_t const first = i;
    while (i < values.size() && std::isnan(values[i])) ++i;
    InputGap gap;
    gap.first = static_cast<int>(first) + 1;
    gap.last = static_cast<int>(i);
    gap.before = first > 0 ? values[first - 1] : std::nan("");
    gap.after = i < values.size() ? values[i] : std::nan("");
    double const from = first > 0 ? gap.before : gap.after, to = i < values.size() ? gap.after : gap.before;
    double const steps = static_cast<double>(i - first + 1);
    for (std::size_t row = first; row < i; ++row) values[row] = from + (to - from) * static_cast<double>(row - first + 1) / steps;
    gaps.push_back(std::move(gap));
  }
  return gaps;
}

void refuse_gaps(Record const& record, RowRange used, RowRange simulated) {
  for (InputGap const& gap : record.gaps) {
    int const around = row_of(record.inputs[gap.input].rule()).reach;
    if (gap.last < used.first - around || gap.first > used.last + around) continue;
    data_errors::Cell const first{record.path, gap.first, gap.line, gap.column};
    if (record.independent_rows) throw UserError(data_errors::gap_in_independent_rows(first, gap.last, gap.mention));
    RowRange const free = longest_without_gap(record.gaps, gap, simulated, around);
    throw UserError(data_errors::gap_in_input(first, {gap.last, gap.before, gap.after}, {simulated.first, simulated.last, around},
                                              {free.first, free.last}, gap.mention));
  }
}

}  // namespace sysid
