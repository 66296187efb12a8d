// Words of other languages and of papers for those of this one, by the place where they stand.
#pragma once
#include <span>
#include <string_view>

namespace sysid::words {

struct ForeignWord {
  std::string_view foreign;  // in small letters
  std::string_view ours;
};

std::span<ForeignWord const> foreign_model_statements();
std::span<ForeignWord const> foreign_data_statements();
std::span<ForeignWord const> foreign_items();
std::span<ForeignWord const> foreign_verbs();
std::span<ForeignWord const> foreign_input_rules();

/// Our word for a foreign one, whatever its capitals; empty for none.
std::string_view translated(std::span<ForeignWord const> table, std::string_view word);

}  // namespace sysid::words
