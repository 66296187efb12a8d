// Lines are written whole, so that a reader, or a kill, finds no half of one.
#include "app/tracking/track_table.hpp"

#include <fcntl.h>
#include <fmt/compile.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <iterator>
#include <utility>

#include "core/system/files.hpp"
#include "core/text/diagnostic.hpp"
#include "report/file/csv.hpp"
#include "report/file/standing_files.hpp"

namespace sysid {
namespace {

constexpr std::size_t enough = 1 << 18;  // bytes gathered before they are written

void add_cell(std::string& line, double value) {
  line += ',';
  if (std::isfinite(value))
    fmt::format_to(std::back_inserter(line), FMT_COMPILE("{:.9g}"), value);
  else
    line += "NaN";
}

}  // namespace

TrackedUnits units_of(Model const& model, std::vector<TrackedParameter> const& tracked) {
  TrackedUnits all;
  auto const add = [&](Quantity const& quantity) {
    all.names.push_back(quantity.name);
    all.units.push_back(quantity.unit_of_numbers());
    all.scales.push_back(quantity.to_si(1));
  };
  for (State const& state : model.states) add(state);
  for (TrackedParameter const& each : tracked) add(model.parameters[static_cast<std::size_t>(each.parameter)]);
  for (Channel const& channel : model.channels) {
    all.channels.push_back(channel.name);
    all.channel_units.push_back(channel.unit_text());
    all.channel_scales.push_back(channel.to_si(1));
  }
  return all;
}

TrackTable::TrackTable(std::filesystem::path const& folder, TrackedUnits const& units, std::string const& head, bool follows)
    : units_(units), path_(folder / tracked_rows), written_(follows ? path_ : partial_path(path_)), follows_(follows) {
  if (!follows_) open();
  lines_ = head + "# units =";
  char const* comma = " ";
  auto const unit = [&](std::string const& name, std::string const& text) {
    lines_ += fmt::format("{}{} [{}]", std::exchange(comma, ", "), name, text);
  };
  for (std::size_t i = 0; i < units_.names.size(); ++i) unit(units_.names[i], units_.units[i]);
  for (std::size_t c = 0; c < units_.channels.size(); ++c) unit(units_.channels[c], units_.channel_units[c]);
  lines_ += "\nrow,t";
  for (std::string const& name : units_.names) lines_ += "," + csv_field(name + "_mean") + "," + csv_field(name + "_sd");
  for (std::string const& name : units_.channels)
    lines_ += "," + csv_field(name + "_innovation") + "," + csv_field(name + "_expected_sd");
  lines_ += ",squared,samples,alarm\n";
}

TrackTable::~TrackTable() {
  if (file_ >= 0) ::close(file_);
  if (!follows_ && !kept_) ::unlink(written_.c_str());
}

void TrackTable::add(TrackedRow const& row) {
  fmt::format_to(std::back_inserter(lines_), FMT_COMPILE("{},{}"), row.row, row.time);
  for (std::size_t i = 0; i < row.mean.size(); ++i) {
    add_cell(lines_, row.mean[i] / units_.scales[i]);
    add_cell(lines_, row.sd[i] / units_.scales[i]);
  }
  for (std::size_t c = 0; c < row.innovation.size(); ++c) {
    add_cell(lines_, row.innovation[c] / units_.channel_scales[c]);
    add_cell(lines_, row.expected[c] / units_.channel_scales[c]);
  }
  add_cell(lines_, row.squared);
  fmt::format_to(std::back_inserter(lines_), FMT_COMPILE(",{},"), row.samples);
  if (row.alarm != nullptr)
    lines_ += csv_field(units_.names[units_.names.size() - row.tracked + static_cast<std::size_t>(row.alarm->parameter)]);
  else if (row.noise != nullptr)
    lines_ += csv_field("noise of " + units_.channels[static_cast<std::size_t>(row.noise->channel)]);
  else if (row.restart != nullptr)
    lines_ += "restart";
  lines_ += '\n';
  if (follows_ || lines_.size() > enough) flush();
}

// Rows that are there at once are a result, so the earlier one goes only now.
void TrackTable::open() {
  if (follows_) remove_result(path_.parent_path(), path_);
  file_ = ::open(written_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0666);
  if (file_ < 0) fail();
}

void TrackTable::flush() {
  if (file_ < 0) open();
  std::size_t at = 0;
  while (at < lines_.size()) {
    ssize_t const count = ::write(file_, lines_.data() + at, lines_.size() - at);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail();
    at += static_cast<std::size_t>(count);
  }
  lines_.clear();
}

void TrackTable::finish() {
  flush();
  if (!follows_ && ::fsync(file_) != 0) fail();
}

std::vector<std::string> TrackTable::taken_over() {
  kept_ = true;
  return {tracked_rows};
}

void TrackTable::fail() const { throw IoError(fmt::format("cannot write `{}`: {}", written_.string(), std::strerror(errno))); }

}  // namespace sysid
