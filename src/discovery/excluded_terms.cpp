// One phrase for each reason.
#include "discovery/excluded_terms.hpp"

#include <fmt/format.h>

namespace sysid {
namespace {

std::string reason(ExcludedTerm const& term) {
  switch (term.why) {
    case ExcludedTerm::Why::same:
      return fmt::format("the same as {}", term.detail);
    case ExcludedTerm::Why::zero:
      return "always zero";
    case ExcludedTerm::Why::excluded:
      return "excluded";
    case ExcludedTerm::Why::unit:
      return fmt::format("its coefficient would be in [{}]", term.detail);
  }
  return {};
}

}  // namespace

std::vector<ExcludedText> excluded_texts(CheckedDictionary const& dictionary) {
  std::vector<ExcludedText> texts;
  for (ExcludedTerm const& term : dictionary.excluded) {
    bool const of_one = term.equation >= 0 && dictionary.equations.size() > 1;
    texts.push_back({of_one
                         ? fmt::format("{} for {}", term.text, dictionary.equations[static_cast<std::size_t>(term.equation)].text)
                         : term.text,
                     reason(term)});
  }
  return texts;
}

}  // namespace sysid
