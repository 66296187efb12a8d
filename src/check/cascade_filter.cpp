// Rules over pairs of messages: one place instead of a flag in every stage.
#include "check/cascade_filter.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <tuple>

#include "check/units/unit_errors.hpp"

namespace sysid {

namespace {

/// A name that does not exist, and what is said of it wherever it stands.
constexpr std::array<std::string_view, 6> unknown_names{"E2001", "E2003", "E2011", "E2101", "E3010", "E6001"};
/// The order and balance of the equations, which need every name in them to be known.
constexpr std::array<std::string_view, 5> balance{"E3002", "E3003", "E3004", "E3005", "E3006"};
/// Something missing of a state, whose name may stand misspelt where it is looked for.
constexpr std::array<std::string_view, 2> lacks{"E3001", "E3007"};

/// What an input cannot have: an initial value, a second derivative.
constexpr std::array<std::string_view, 2> of_input{"E3010", "E2008"};

template <class Codes>
bool is_one_of(Diagnostic const& diagnostic, Codes const& codes) {
  return std::find(codes.begin(), codes.end(), diagnostic.code) != codes.end();
}

bool within(Span inner, Span outer) { return outer.begin <= inner.begin && inner.end <= outer.end; }

std::string subject(Diagnostic const& diagnostic) { return diagnostic.names.empty() ? "" : diagnostic.names.front(); }

/// The model a message points into, counted from 0; -1 for anywhere else, which is one space of names.
int model_of(ast::File const& file, Diagnostic const& diagnostic) {
  for (std::size_t i = 0; i < file.items.size() && diagnostic.primary; ++i)
    if (auto const* model = std::get_if<ast::Model>(&file.items[i]);
        model != nullptr && within(diagnostic.primary->span, model->span))
      return static_cast<int>(i);
  return -1;
}

}  // namespace

void remove_cascades(ast::File const& file, Diagnostics& diagnostics) {
  std::vector<Diagnostic> all = diagnostics.all();
  std::stable_sort(all.begin(), all.end(), [](Diagnostic const& a, Diagnostic const& b) {
    return (a.primary ? a.primary->span.begin : ~0U) < (b.primary ? b.primary->span.begin : ~0U);
  });
  std::map<int, std::set<std::string>> unknown_in;  // by model: the names offered in place of its unknown ones
  std::vector<Span> unknown_arguments, moving_priors;
  for (Diagnostic const& each : all) {
    int const model = model_of(file, each);
    if (model >= 0 && is_one_of(each, unknown_names)) unknown_in[model].insert(each.suggested.begin(), each.suggested.end());
    if (each.code == "E2102" && each.primary) unknown_arguments.push_back(each.primary->span);
    if (each.code == "E2110" && each.primary) moving_priors.push_back(each.primary->span);
  }
  // What is declared twice counts as the first; an input that has an initial value is meant as a state.
  std::set<std::pair<int, std::string>> declared_twice, not_states;
  for (Diagnostic const& each : all) {
    if (each.code == "E2002") declared_twice.insert({model_of(file, each), subject(each)});
    if (each.code == "E3010") not_states.insert({model_of(file, each), subject(each)});
  }
  std::set<std::tuple<int, std::string, std::string, std::string>> said;
  std::set<std::tuple<std::string, std::uint32_t, std::uint32_t, std::uint32_t>> units_said;
  auto const follows = [&](Diagnostic const& each) {
    int const model = model_of(file, each);
    std::pair<int, std::string> const quantity{model, each.names.empty() ? "" : each.names.back()};
    if (is_one_of(each, of_input) && declared_twice.contains(quantity)) return true;
    if (each.code == "E2008" && not_states.contains(quantity)) return true;
    if (is_one_of(each, unknown_names)) {
      // A `y` that is not declared and a `y` that is not a state are one mistake: what counts is the name.
      return !said.insert({model, model >= 0 ? "" : each.code, each.kind, subject(each)}).second;
    }
    // The elements of a vector are told apart by where their terms stand, and share the mistake. In a function, told at its call,
    // the place in its body tells mistakes apart.
    if (errors::is_unit_conflict(each)) {
      bool const at_call = !each.function.empty() && !each.secondary.empty();
      Span const place = each.primary->span;
      if (std::any_of(moving_priors.begin(), moving_priors.end(), [&](Span prior) { return within(place, prior); })) return true;
      return !units_said.insert({each.code, place.begin, place.end, at_call ? each.secondary.front().span.begin : 0U}).second;
    }
    if (is_one_of(each, balance)) return unknown_in.contains(model);
    if (is_one_of(each, lacks)) return unknown_in.contains(model) && unknown_in[model].contains(subject(each));
    return each.code == "E2105" && each.primary &&
           std::any_of(unknown_arguments.begin(), unknown_arguments.end(),
                       [&](Span argument) { return within(argument, each.primary->span); });
  };
  std::erase_if(all, follows);
  diagnostics.replace(std::move(all));
}

}  // namespace sysid
