// Names of the language as symbols of a formula: `k3` is k with the index 3, `omega_n` a Greek letter with the index n.
#pragma once
#include <compare>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

/// A letter or a word, and its indices from left to right.
struct TypesetSymbol {
  std::string base;
  std::vector<std::string> indices;
  friend auto operator<=>(TypesetSymbol const&, TypesetSymbol const&) = default;
};

/// Digits at the end of a letter and what follows an underscore are indices; of `spring.k3`, so is `spring`. A name of several
/// letters, `Cd`, stays whole: nobody but its user knows whether it is one symbol or two.
TypesetSymbol symbol(std::string_view name);

/// The symbols of the names of one model. Names that would be printed alike, `k1` and `k_1`, are printed as they are typed.
class Symbols {
 public:
  /// The symbol of a name, which is known from now on: what has been written before another name like it came up is to be written
  /// again.
  TypesetSymbol operator()(std::string const& name);

 private:
  std::map<TypesetSymbol, std::string> names_;
  std::set<std::string> alike_;
};

/// A Greek letter: the name it is typed by (`alpha`, or itself), the letter, and LaTeX's command ("" where a Latin letter serves).
struct GreekLetter {
  std::string_view name, letter, command;
};
/// By its name or by the letter; nothing for other text.
GreekLetter const* greek_letter(std::string_view text);

}  // namespace sysid
