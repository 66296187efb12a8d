// One phrase for each reason.
#include "discovery/excluded_terms.hpp"

#include <fmt/format.h>

namespace sysid {
namespace {

std::string reason(LeftOutTerm const& term) {
  switch (term.why) {
    case LeftOutTerm::Why::same:
      return fmt::format("the same as {}", term.detail);
    case LeftOutTerm::Why::zero:
      return "always zero";
    case LeftOutTerm::Why::excluded:
      return "excluded";
    case LeftOutTerm::Why::unit:
      return fmt::format("its coefficient would be in [{}]", term.detail);
  }
  return {};
}

}  // namespace

std::vector<LeftOutText> left_out_texts(CheckedDictionary const& dictionary) {
  std::vector<LeftOutText> texts;
  for (LeftOutTerm const& term : dictionary.left_out) {
    bool const of_one = term.equation >= 0 && dictionary.equations.size() > 1;
    texts.push_back({of_one
                         ? fmt::format("{} for {}", term.text, dictionary.equations[static_cast<std::size_t>(term.equation)].text)
                         : term.text,
                     reason(term)});
  }
  return texts;
}

}  // namespace sysid
