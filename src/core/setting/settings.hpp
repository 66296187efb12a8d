// Named settings of a back end or task: a table says what there is; the checker refuses the rest by name; a Settings holds the
// values.
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace sysid {

enum class SettingKind {
  integer,
  real,
  word,
  flag,
  numbers,  // a list `(3, 2, 1)`; by default empty
};

struct SettingRow {
  std::string_view name;
  SettingKind kind;
  std::string_view fallback;   // the default, as the user would write it
  double minimum;              // smallest allowed number, inclusive (integer, real, each of numbers)
  double maximum;              // largest allowed number, inclusive
  std::string_view choices;    // for a word: "adaptive spherical", separated by blanks
  std::string_view summary;    // one line for `sysid list` and the docs
  double least_positive = 0;   // of a real whose 0 stands for something else: no smaller number above 0
  std::string_view unit = {};  // of a real: in which a bare number counts, as "s"; empty: a pure number
};

using SettingValue = std::variant<std::int64_t, double, std::string, bool, std::vector<double>>;

/// As the user would write it: `0.2`, `gaussian`, `yes`, `(3, 2, 1)`.
std::string setting_text(SettingValue const& value);

/// The row of a name, or nullptr.
SettingRow const* find_setting(std::span<SettingRow const> rows, std::string_view name);

/// Why `value` cannot be given to the row's setting ("it must be a whole number of at least 1"); empty when it can.
std::string refuse(SettingRow const& row, SettingValue const& value);

/// Of rows whose settings go with each other in any combination.
inline std::string no_refusal(class Settings const&) { return {}; }

/// Values by name; every row of the table has one, given or default.
class Settings {
 public:
  Settings() = default;
  /// All defaults of the table.
  explicit Settings(std::span<SettingRow const> rows);

  void set(std::string const& name, SettingValue value) { values_[name] = std::move(value); }
  /// A name that the table lacks, or one of another kind, is a fault of ours: InternalError. `real` also reads an integer.
  std::int64_t integer(std::string const& name) const;
  double real(std::string const& name) const;
  std::string const& word(std::string const& name) const;
  bool flag(std::string const& name) const;
  std::vector<double> const& numbers(std::string const& name) const;
  std::map<std::string, SettingValue> const& all() const { return values_; }
  friend bool operator==(Settings const&, Settings const&) = default;

 private:
  SettingValue const& at(std::string const& name) const;
  std::map<std::string, SettingValue> values_;
};

}  // namespace sysid
