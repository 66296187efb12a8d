// The page of a dictionary: its terms with the units of their coefficients, and the terms that were left out.
#include <fmt/format.h>

#include "app/preflight/check_file.hpp"
#include "check/expression/scope.hpp"
#include "discovery/excluded_terms.hpp"

namespace sysid {
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
                             term.in_target             ? "in the target, always kept"
                             : term.coefficient.empty() ? ""
                                                        : "coefficient " + term.coefficient});
    page.equations.push_back(std::move(entry));
  }
  for (ExcludedText const& each : excluded_texts(dictionary)) page.excluded.push_back(each.term + ": " + each.reason);
  return page;
}

}  // namespace sysid
