// Words of other languages and of papers for those of this one, by the place where they stand.
#pragma once
#include <optional>
#include <span>
#include <string>
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

/// A derivative as a name of its own: `ydot`, `y_tt`, `d2ydt2`.
struct DerivativeWord {
  std::string of;
  int primes;
};
/// The name among the known that it differentiates. brief: also with one or two letters behind the name, which may mean another
/// thing: `yd`, `y_t`.
std::optional<DerivativeWord> as_derivative(std::string_view name, std::span<std::string const> known, bool brief);

}  // namespace sysid::words
