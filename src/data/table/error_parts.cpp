#include "data/table/error_parts.hpp"

#include <fmt/format.h>

#include <utility>

#include "core/text/utf8.hpp"
#include "core/text/words.hpp"
#include "data/cell/unit_text.hpp"

namespace sysid::data_errors {

Diagnostic error(std::string code, Mention mention, std::string message, std::string help) {
  Diagnostic result{Severity::error, std::move(code), std::move(message), {}, {}, std::move(help)};
  if (mention) result.primary = Label{*mention, {}};
  return result;
}

std::string place(std::string const& file, std::int64_t row, std::int64_t line) {
  return line > 0 ? fmt::format("`{}` row {} (line {})", file, row, line) : fmt::format("`{}` row {}", file, row);
}

std::string place(Cell const& cell) { return fmt::format("{}, column `{}`", place(cell.file, cell.row, cell.line), cell.column); }

std::string shown(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string result;
  for (char const c : text.substr(0, character_begin(text, longest)))
    result += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return text.size() > longest ? result + "..." : result;
}

std::string column_names(std::vector<std::string> const& names) {
  std::vector<std::string> marked;
  for (std::string const& name : names) marked.push_back(fmt::format("`{}`", shown(name)));
  return first_listed(marked, 20);
}

std::string as_unit(std::string_view text) {
  auto const unit = unit_of_text(text);
  return unit ? unit->text : std::string();
}

}  // namespace sysid::data_errors
