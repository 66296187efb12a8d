// Columns side by side.
#include "report/file/simulated_csv.hpp"

#include "core/system/interrupt.hpp"
#include "core/text/number.hpp"
#include "report/file/csv.hpp"

namespace sysid {
namespace {

constexpr std::size_t many = 1 << 14;  // rows between two looks at the signals

}  // namespace

MadeRecord::MadeRecord(std::string place, std::vector<double> values) : header_(place), taken_{std::move(place)} {
  columns_.push_back(std::move(values));
}

std::string MadeRecord::take_name(std::string name, std::string const& suffix) {
  if (taken_.contains(name)) name += suffix;
  while (!taken_.insert(name).second) name += "_";
  return name;
}

void MadeRecord::add(std::string const& name, std::vector<double> values) {
  header_ += "," + csv_field(name);
  columns_.push_back(std::move(values));
}

std::string MadeRecord::text() const {
  std::string text = comments_ + header_ + "\n";
  for (std::size_t i = 0; i < columns_.front().size(); ++i) {
    if (i % many == 0) stop_if_interrupted();
    for (std::size_t c = 0; c < columns_.size(); ++c) text += shortest(columns_[c][i]) + (c + 1 == columns_.size() ? "\n" : ",");
  }
  return text;
}

std::string unit_suffix(std::string const& unit) { return unit.empty() ? std::string() : " [" + unit + "]"; }

}  // namespace sysid
