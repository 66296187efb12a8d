// Combinations of the supports of equations.
#include "discovery/found_structure.hpp"

#include <algorithm>

#include "core/numeric/elementary.hpp"

namespace sysid {

std::vector<FoundStructure> best_structures(regression::Discovery const& discovery, int most) {
  std::vector<FoundStructure> all = {{}};
  for (regression::FoundEquation const& equation : discovery.equations) {
    if (!equation.found) return {};
    std::vector<regression::Support const*> supports = {&equation.chosen};
    for (regression::Support const& each : equation.supports)
      if (each.terms != equation.chosen.terms) supports.push_back(&each);
    bool const probable = equation.chosen.probability > 0 && equation.chosen.probability < 1;
    auto const score = [&](regression::Support const& support) {
      return probable ? elementary::log(support.probability) : support.log_evidence;
    };
    std::vector<FoundStructure> more;
    for (FoundStructure const& before : all)
      for (regression::Support const* support : supports) {
        more.push_back(before);
        more.back().equations.push_back(support);
        more.back().score += score(*support);
      }
    // What was chosen stays first, whatever scores higher.
    std::stable_sort(more.begin() + 1, more.end(), [](auto const& a, auto const& b) { return a.score > b.score; });
    if (more.size() > static_cast<std::size_t>(most)) more.resize(static_cast<std::size_t>(most));
    all = std::move(more);
  }
  for (std::size_t m = 0; m < all.size(); ++m) all[m].of_regression = static_cast<int>(m) + 1;
  return all;
}

bool is_offered(regression::FoundEquation const& equation, std::size_t term) {
  constexpr std::size_t few = 3;
  if (!equation.terms[term].excluded) return true;
  return std::any_of(equation.concerns.begin(), equation.concerns.end(), [&](regression::Concern const& each) {
    return each.kind == regression::Concern::Kind::collinear && each.terms.front() == static_cast<int>(term) &&
           each.terms.size() > 1 + few;
  });
}

std::string structure_text(CheckedDictionary const& dictionary, FoundStructure const& structure) {
  std::string text;
  for (std::size_t e = 0; e < structure.equations.size(); ++e) {
    DictionaryEquation const& equation = dictionary.equations[e];
    std::string terms;
    for (int const j : structure.equations[e]->terms) {
      DictionaryTerm const& term = equation.terms[static_cast<std::size_t>(j)];
      if (!term.in_target) terms += (terms.empty() ? "" : ", ") + term.text;
    }
    if (terms.empty()) terms = "none";
    text += (e == 0 ? "" : "; ") + (structure.equations.size() > 1 ? equation.text + ": " + terms : terms);
  }
  return text;
}

}  // namespace sysid
