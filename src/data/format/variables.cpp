// Finds arrays by path, and rows and columns of matrices among them.
#include "data/format/variables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/system/memory.hpp"
#include "core/text/words.hpp"
#include "data/format/own_process.hpp"
#include "data/format/record_libraries.hpp"
#include "data/table/cell_errors.hpp"
#include "data/table/file_errors.hpp"

namespace sysid {
namespace {

constexpr std::size_t overhead = std::size_t{1} << 30U;  // of the libraries, with their tables
constexpr std::size_t most_columns = 64;                 // of a matrix that are listed

/// `X[:, 2]`: the variable and which of its rows or columns; index 0: all of it.
struct Choice {
  std::string path;
  std::size_t row = 0, column = 0;
  bool chosen = false;
};

std::optional<Choice> choice_of(std::string_view text) {
  text = trimmed(text);
  Choice choice{std::string(text)};
  if (!text.ends_with(']') && !text.ends_with(')')) return choice;
  char const opening = text.back() == ']' ? '[' : '(';
  std::size_t const open = text.rfind(opening), comma = text.find(',', open);
  if (open == std::string_view::npos || open == 0 || comma == std::string_view::npos) return std::nullopt;
  auto const number = [](std::string_view part) -> std::optional<std::size_t> {
    part = trimmed(part);
    if (part == ":") return 0;
    std::size_t value = 0;
    auto const [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc{} || end != part.data() + part.size() || value == 0) return std::nullopt;
    return value;
  };
  auto const row = number(text.substr(open + 1, comma - open - 1));
  auto const column = number(text.substr(comma + 1, text.size() - comma - 2));
  if (!row || !column || (*row == 0) == (*column == 0)) return std::nullopt;
  return Choice{std::string(trimmed(text.substr(0, open))), *row, *column, true};
}

std::size_t count_of(std::vector<std::size_t> const& size) {
  double all = 1;
  for (std::size_t const each : size) all *= static_cast<double>(each);
  return all < 1e15 ? static_cast<std::size_t>(all) : SIZE_MAX / 16;
}

/// At most one dimension is longer than 1.
bool is_vector(std::vector<std::size_t> const& size) {
  return std::count_if(size.begin(), size.end(), [](std::size_t each) { return each != 1; }) <= 1;
}

std::string size_text(std::vector<std::size_t> const& size) {
  std::string text;
  for (std::size_t const each : size) text += (text.empty() ? "" : " x ") + std::to_string(each);
  return text.empty() ? "1" : text;
}

std::string packed(std::vector<Variable> const& variables) {
  nlohmann::json all = nlohmann::json::array();
  for (Variable const& each : variables) all.push_back({each.path, each.size, each.refused, each.unit});
  return all.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::vector<Variable> unpacked(std::string const& bytes) {
  std::vector<Variable> variables;
  for (nlohmann::json const& each : nlohmann::json::parse(bytes))
    variables.push_back({each.at(0), each.at(1), each.at(2), each.at(3)});
  return variables;
}

/// UserError E4025 for a word: in an array of numbers it stands nowhere.
std::vector<double> marks_of(std::vector<std::string> const& words, std::string const& file, std::string_view format) {
  std::vector<double> numbers;
  for (std::string const& word : words) {
    double number = 0;
    auto const [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    bool const is_number = error == std::errc{} && end == word.data() + word.size();
    if (!is_number && word != "NA") throw UserError(data_errors::word_among_numbers(file, format, word, std::nullopt));
    if (is_number) numbers.push_back(number);
  }
  return numbers;
}

class VariableRecord final : public RecordFile {
 public:
  VariableRecord(VariableFormat const& format, std::string name, std::string const& bytes, std::string digest,
                 ReadingRules const& rules)
      : missing_(marks_of(rules.missing, name, format.name)),
        format_(format),
        name_(std::move(name)),
        digest_(std::move(digest)),
        file_(std::make_unique<RecordCopy>(bytes)) {
    open_record_libraries();  // a process of its own may open one file
    OwnWork const listed = in_own_process(overhead + 2 * file_->size(), [&] { return packed(format_.list(file_->path())); });
    if (listed.end == WorkEnd::failed && format_.refusal != nullptr)
      if (std::string const why = format_.refusal(bytes); !why.empty())
        throw UserError(data_errors::linked_elsewhere(name_, why, std::nullopt));
    require_done(listed, std::nullopt);
    variables_ = unpacked(listed.result);
    for (Variable const& each : variables_) {
      if (!each.refused.empty()) continue;
      if (is_vector(each.size)) {
        columns_.push_back(each.path);
      } else if (each.size.size() == 2) {
        bool const along = each.size[0] >= each.size[1];
        std::size_t const lines = along ? each.size[1] : each.size[0];
        for (std::size_t i = 1; i <= std::min(lines, most_columns); ++i)
          columns_.push_back(along ? fmt::format("{}[:, {}]", each.path, i) : fmt::format("{}[{}, :]", each.path, i));
      }
    }
  }

  std::string const& name() const override { return name_; }
  std::string const& digest() const override { return digest_; }
  std::vector<std::string> const& columns() const override { return columns_; }
  std::vector<std::string> const& comments() const override { return comments_; }

  std::vector<std::pair<std::string, std::string>> left_out() const override {
    constexpr std::size_t longest = 20;
    std::vector<std::pair<std::string, std::string>> all;
    for (Variable const& each : variables_)
      if (!each.refused.empty() && all.size() < longest) all.emplace_back(each.path, each.refused);
    return all;
  }

  std::optional<std::string> unit(std::string const& column) const override {
    auto const choice = choice_in_file(column);
    Variable const* const variable = choice ? find(choice->path) : nullptr;
    if (variable == nullptr || variable->unit.empty()) return std::nullopt;
    return variable->unit.substr(0, variable->unit.find(" since "));  // CF: seconds since 2024-05-01
  }

  std::vector<double> numbers(std::string const& column, std::optional<Span> mention) const override {
    auto const choice = choice_in_file(column);
    Variable const* const variable = choice ? find(choice->path) : nullptr;
    if (variable == nullptr) {
      if (Variable const* const whole = refused_around(column)) throw refused(whole->path, whole->refused, mention);
      throw UserError(data_errors::missing_variable(name_, column, columns_, mention));
    }
    if (!variable->refused.empty()) throw refused(column, variable->refused, mention);
    std::vector<double> values = chosen(*variable, *choice, column, mention);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (is_missing(values[i]))
        values[i] = std::nan("");
      else if (std::isinf(values[i]))
        throw UserError(data_errors::not_finite(place(i, column), values[i] > 0 ? "inf" : "-inf", mention));
    return values;
  }

 private:
  bool is_missing(double value) const {
    return std::any_of(missing_.begin(), missing_.end(), [&](double each) {
      return value == each || value == static_cast<double>(static_cast<float>(each));  // columns may have single precision
    });
  }
  /// `Signal` of `Signal(1).values`.
  Variable const* refused_around(std::string const& column) const {
    for (std::size_t at = column.find_first_of(".(/["); at != std::string::npos; at = column.find_first_of(".(/[", at + 1))
      if (Variable const* const whole = find(column.substr(0, at)); whole != nullptr && !whole->refused.empty()) return whole;
    return nullptr;
  }
  void require_done(OwnWork const& work, std::optional<Span> mention) const {
    if (work.end == WorkEnd::waited) throw UserError(data_errors::reading_waited(name_, std::string(format_.name), mention));
    if (work.end == WorkEnd::failed) throw UserError(data_errors::damaged(name_, std::string(format_.name), mention));
  }
  Variable const* find(std::string const& path) const {
    auto const found = std::find_if(variables_.begin(), variables_.end(), [&](Variable const& each) { return each.path == path; });
    return found == variables_.end() ? nullptr : &*found;
  }
  /// A name with brackets in it goes before a choice of rows.
  std::optional<Choice> choice_in_file(std::string const& column) const {
    return find(column) != nullptr ? std::optional(Choice{column}) : choice_of(column);
  }
  UserError refused(std::string const& column, std::string const& reason, std::optional<Span> mention) const {
    return UserError(data_errors::no_column_of_numbers(name_, column, reason, columns_, mention));
  }
  std::vector<double> chosen(Variable const& variable, Choice const& choice, std::string const& column,
                             std::optional<Span> mention) const {
    std::vector<std::size_t> const& size = variable.size;
    if (!choice.chosen && !is_vector(size))
      throw refused(column,
                    fmt::format("is an array of {}{}", size_text(size),
                                size.size() == 2
                                    ? fmt::format(": write `\"{0}[:, 1]\"` for its first column, `\"{0}[1, :]\"` for its first row",
                                                  variable.path)
                                    : ""),
                    mention);
    if (choice.chosen && (size.size() != 2 || choice.row > size[0] || choice.column > size[1]))
      throw refused(column, fmt::format("has no such row or column: it is an array of {}", size_text(size)), mention);
    std::vector<double> const& all = read(variable, mention);
    if (!choice.chosen) return all;
    std::vector<double> values;
    if (choice.row > 0)
      values.assign(all.begin() + static_cast<std::ptrdiff_t>((choice.row - 1) * size[1]),
                    all.begin() + static_cast<std::ptrdiff_t>(choice.row * size[1]));
    else
      for (std::size_t row = 0; row < size[0]; ++row) values.push_back(all[row * size[1] + choice.column - 1]);
    return values;
  }
  /// The array that was read last is kept: the columns of a matrix are asked for one after the other.
  std::vector<double> const& read(Variable const& variable, std::optional<Span> mention) const {
    if (read_path_ == variable.path) return read_;
    std::size_t const count = count_of(variable.size);
    require_memory(fmt::format("reading `{}` of `{}`", variable.path, name_), 24.0 * static_cast<double>(count),
                   "read a shorter record");
    OwnWork const work = in_own_process(overhead + 2 * file_->size() + 32 * count, [&] {
      std::vector<double> const values = format_.read(file_->path(), variable.path);
      return std::string(reinterpret_cast<char const*>(values.data()), values.size() * sizeof(double));
    });
    require_done(work, mention);
    if (work.result.size() != count * sizeof(double))
      throw UserError(data_errors::damaged(name_, std::string(format_.name), mention));
    read_.resize(count);
    if (count > 0) std::memcpy(read_.data(), work.result.data(), work.result.size());
    read_path_ = variable.path;
    return read_;
  }

  std::vector<double> missing_;
  VariableFormat const& format_;
  std::string name_, digest_;
  std::unique_ptr<RecordCopy> file_;
  std::vector<Variable> variables_;
  std::vector<std::string> columns_, comments_;
  mutable std::vector<double> read_;
  mutable std::string read_path_;
};

}  // namespace

std::unique_ptr<RecordFile> open_variables(VariableFormat const& format, std::string path, std::string const& bytes,
                                           std::string digest, ReadingRules const& rules) {
  return std::make_unique<VariableRecord>(format, std::move(path), bytes, std::move(digest), rules);
}

}  // namespace sysid
