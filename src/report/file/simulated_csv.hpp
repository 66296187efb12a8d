// The CSV of a record that the program makes, as a data block reads it: comment lines, one header, shortest round-trip decimals.
#pragma once
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace sysid {

class MadeRecord {
 public:
  /// place: name of the first column, of times or rows.
  MadeRecord(std::string place, std::vector<double> values);

  /// A name that no column has yet: as given, with the suffix, or with underscores behind it. It is taken from then on.
  std::string take_name(std::string name, std::string const& suffix);
  void comment(std::string const& line) { comments_ += "# " + line + "\n"; }
  /// The next column, under a name that was taken.
  void add(std::string const& name, std::vector<double> values);
  std::string text() const;

 private:
  std::string comments_, header_;
  std::set<std::string> taken_;
  std::vector<std::vector<double>> columns_;
};

/// " [N]"; empty where there is no unit.
std::string unit_suffix(std::string const& unit);

}  // namespace sysid
