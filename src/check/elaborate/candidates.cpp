// The product of the values of each argument.
#include "check/elaborate/candidates.hpp"

#include "check/elaborate/tree.hpp"
#include "check/elaborate/whole_number.hpp"
#include "check/message/errors_reuse.hpp"

namespace sysid {
namespace {

constexpr std::size_t most_candidates = 1000;

std::optional<std::vector<ast::Expression>> values(ast::Argument const& argument, Diagnostics& diagnostics) {
  if (auto const* list = std::get_if<ast::Box<ast::List>>(&argument.value.node)) return (*list)->items;
  auto const* range = std::get_if<ast::Box<ast::Binary>>(&argument.value.node);
  if (range == nullptr || (*range)->symbol != "..") return std::vector{argument.value};
  auto const first = whole_number(*(*range)->left, {}), last = whole_number(*(*range)->right, {});
  if (!first || !last) {
    ast::Expression const& wrong = first ? *(*range)->right : *(*range)->left;
    diagnostics.add(errors::whole_number_needed(wrong.span, {"an end of this range"}));
    return std::nullopt;
  }
  if (*last < *first || *last - *first >= static_cast<long>(most_candidates)) {
    diagnostics.add(errors::candidate_range(argument.value.span, *last - *first + 1, most_candidates));
    return std::nullopt;
  }
  std::vector<ast::Expression> numbers;
  for (long value = *first; value <= *last; ++value)
    numbers.push_back(value < 0
                          ? tree::unary("-", tree::number(static_cast<double>(-value), argument.value.span), argument.value.span)
                          : tree::number(static_cast<double>(value), argument.value.span));
  return numbers;
}

}  // namespace

std::optional<std::vector<std::vector<ast::Argument>>> expanded(std::vector<ast::Argument> const& arguments,
                                                                Diagnostics& diagnostics) {
  std::vector<std::vector<ast::Argument>> all(1);
  for (ast::Argument const& argument : arguments) {
    auto const each = values(argument, diagnostics);
    if (!each) return std::nullopt;
    if (all.size() * each->size() > most_candidates) {
      diagnostics.add(errors::candidate_range(argument.value.span, static_cast<long>(all.size() * each->size()), most_candidates));
      return std::nullopt;
    }
    std::vector<std::vector<ast::Argument>> longer;
    for (std::vector<ast::Argument> const& begun : all)
      for (ast::Expression const& value : *each) {
        longer.push_back(begun);
        longer.back().push_back({{argument.span}, argument.name, value});
      }
    all = std::move(longer);
  }
  return all;
}

}  // namespace sysid
