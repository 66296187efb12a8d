// A dictionary as it was written out: terms with the units of their coefficients, and what is not among them.
#include <fmt/format.h>

#include "app/check_file.hpp"
#include "check/scope.hpp"

namespace sysid {
namespace {

std::string reason(LeftOutTerm const& term, CheckedDictionary const& dictionary) {
  std::string const of = term.equation >= 0 && dictionary.equations.size() > 1
                             ? " for " + dictionary.equations[static_cast<std::size_t>(term.equation)].text
                             : std::string();
  switch (term.why) {
    case LeftOutTerm::Why::same:
      return fmt::format("{}{}: the same as {}", term.text, of, term.detail);
    case LeftOutTerm::Why::zero:
      return fmt::format("{}: always zero", term.text);
    case LeftOutTerm::Why::excluded:
      return fmt::format("{}: excluded", term.text);
    case LeftOutTerm::Why::unit:
      return fmt::format("{}{}: its coefficient would be in [{}]", term.text, of, term.detail);
  }
  return {};
}

}  // namespace

DictionaryPage describe_dictionary(CheckedDictionary const& dictionary) {
  DictionaryPage page;
  page.name = dictionary.name;
  page.title = dictionary.title;
  for (std::size_t s = 0; s < dictionary.states.size(); ++s) {
    std::string text;
    for (regression::Channel const& channel : dictionary.numbers.channels)
      if (channel.state == static_cast<int>(s))
        text += fmt::format("{}{}measured as {}", text.empty() ? "" : ", ",
                            channel.order == 0 ? "" : primed_name(dictionary.states[s].name, channel.order) + " ", channel.name);
    page.states.push_back({dictionary.states[s].name, dictionary.states[s].unit_text(), text});
  }
  for (Quantity const& input : dictionary.measured.inputs) page.inputs.push_back({input.name, input.unit_text(), {}});
  for (DictionaryEquation const& equation : dictionary.equations) {
    DictionaryPage::Equation entry{equation.text, equation.unit ? equation.unit->text : std::string(), {}};
    for (DictionaryTerm const& term : equation.terms)
      entry.terms.push_back({term.text, term.unit ? term.unit->text : "",
                             term.in_target             ? "known, in the target"
                             : term.coefficient.empty() ? ""
                                                        : "coefficient " + term.coefficient});
    page.equations.push_back(std::move(entry));
  }
  for (LeftOutTerm const& term : dictionary.left_out) page.left_out.push_back(reason(term, dictionary));
  return page;
}

}  // namespace sysid
