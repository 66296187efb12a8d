// Column widths over runs of neighbours.
#include "grammar/format/columns.hpp"

#include <algorithm>

#include "core/text/utf8.hpp"

namespace sysid::grammar {

namespace {

bool is_comment(Item const& item) { return item.pieces.empty(); }

/// A comment among the cells ends the line there.
bool has_cells(Item const& item) {
  if (!item.cells) return false;
  int const last = std::max({1, item.cells->unit, item.cells->sign});
  for (int i = 1; i <= last && i < static_cast<int>(item.pieces.size()); ++i)
    if (!item.pieces[static_cast<std::size_t>(i)].comments.empty()) return false;
  return true;
}

/// Calls use(rows) for each longest run of neighbours that have cells and satisfy same(previous, next); comments lie between them.
template <class Same, class Use>
void for_each_run(std::span<Item> items, Same const& same, Use const& use) {
  std::vector<Item*> run;
  auto const finish = [&] {
    if (!run.empty()) use(run);
    run.clear();
  };
  for (Item& item : items) {
    if (item.blank_line_before) finish();
    if (is_comment(item)) continue;
    if (!has_cells(item) || (!run.empty() && !same(*run.back(), item))) finish();
    if (has_cells(item)) run.push_back(&item);
  }
  finish();
}

int width_of(Item const& item, int first, int last) {
  int total = 0;
  for (int i = first; i < last; ++i) {
    Piece const& piece = item.pieces[static_cast<std::size_t>(i)];
    total += text_width(piece.text) + (i > first && piece.blank_before ? 1 : 0);
  }
  return total;
}

void align_names(std::vector<Item*> const& rows) {
  int widest = 0;
  for (Item const* row : rows) widest = std::max(widest, text_width(row->pieces[0].text));
  for (Item* row : rows) row->pieces[1].padding = widest - text_width(row->pieces[0].text);
}

void align_units_and_signs(std::vector<Item*> const& rows) {
  int name = 0, unit = 0;
  for (Item const* row : rows) {
    int const first = row->cells->keyword.empty() ? 0 : 1, end_of_name = row->cells->unit > 0 ? row->cells->unit : row->cells->sign;
    if (end_of_name > 0) name = std::max(name, width_of(*row, first, end_of_name));
    if (row->cells->unit > 0 && row->cells->sign > 0) unit = std::max(unit, 1 + width_of(*row, row->cells->unit, row->cells->sign));
  }
  for (Item* row : rows) {
    int const first = row->cells->keyword.empty() ? 0 : 1, unit_at = row->cells->unit, sign_at = row->cells->sign;
    if (unit_at > 0) row->pieces[static_cast<std::size_t>(unit_at)].padding = name - width_of(*row, first, unit_at);
    if (sign_at < 0) continue;
    int const used = unit_at > 0 ? name + 1 + width_of(*row, unit_at, sign_at) : width_of(*row, first, sign_at);
    row->pieces[static_cast<std::size_t>(sign_at)].padding = name + unit - used;
  }
}

}  // namespace

void align(std::span<Item> items) {
  for_each_run(
      items,
      [](Item const& a, Item const& b) { return a.level == b.level && a.cells->keyword.empty() == b.cells->keyword.empty(); },
      [](std::vector<Item*> const& rows) {
        if (!rows.front()->cells->keyword.empty()) align_names(rows);
      });
  for_each_run(
      items, [](Item const& a, Item const& b) { return a.level == b.level && a.cells->keyword == b.cells->keyword; },
      align_units_and_signs);
}

}  // namespace sysid::grammar
