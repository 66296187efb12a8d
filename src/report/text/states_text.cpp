// How large each is along the record, and how surely it is known.
#include "report/text/states_text.hpp"

#include <cmath>

#include "core/text/number.hpp"

namespace sysid {

StateSize size_of(PredictedQuantity const& quantity) {
  StateSize size;
  double count = 0;
  for (std::size_t i = 0; i < quantity.response.mean.size(); ++i) {
    double const mean = quantity.response.mean[i], sd = quantity.response.sd[i];
    if (!std::isfinite(mean) || !std::isfinite(sd)) continue;
    size.rms += mean * mean;
    size.sd += sd * sd;
    ++count;
  }
  if (count == 0) return {std::nan(""), std::nan("")};
  return {std::sqrt(size.rms / count), std::sqrt(size.sd / count)};
}

ReportTable states_table(Report const& report) {
  ReportTable table{
      "States and disturbances",
      "Estimated from all samples of the record. rms: root mean square of the posterior mean along the record; sd: root mean "
      "square of the posterior sd, which includes the uncertainty of the parameters. Where sd is about as large as rms, the record "
      "hardly determines the quantity.",
      {"quantity", "unit", "rms", "sd"},
      {}};
  bool const several = report.states.size() > 1;
  if (several) table.header.insert(table.header.begin() + 1, "record");
  for (Prediction const& along : report.states)
    for (PredictedQuantity const& each : along.quantities) {
      StateSize const size = size_of(each);
      std::vector<std::string> row = {each.average ? each.name + ", mean between samples" : each.name, each.unit,
                                      significant(size.rms, 3), significant(size.sd, 3)};
      if (several) row.insert(row.begin() + 1, along.experiment);
      table.rows.push_back(std::move(row));
    }
  return table;
}

}  // namespace sysid
