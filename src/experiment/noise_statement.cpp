// By the tree of the user's text, which is parsed once more: the checked model has no words.
#include "experiment/noise_statement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/text/diagnostic.hpp"
#include "core/text/free_name.hpp"
#include "syntax/parse.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

bool covers(Span whole, Span part) { return whole.begin <= part.begin && part.end <= whole.end; }

/// The argument that is the location: the first by position, or the one of its name.
ast::Argument* location_of(ast::Call& noise, DistributionRow const& row) {
  auto const& spellings = row.arguments.front().spellings;
  auto const at = std::find_if(noise.arguments.begin(), noise.arguments.end(), [&](ast::Argument const& each) {
    return !each.name ||
           std::any_of(spellings.begin(), spellings.end(), [&](Spelling const& s) { return s.name == each.name->text; });
  });
  return at == noise.arguments.end() ? nullptr : &*at;
}

/// The model of the text that observes the channel; null where it stands in a module.
ast::Model* model_of(ast::File& tree, Channel const& channel) {
  for (ast::Item& item : tree.items)
    if (auto* const model = std::get_if<ast::Model>(&item); model != nullptr && covers(model->span, channel.span)) return model;
  return nullptr;
}

/// The statement of it that does; null where it stands in a module.
ast::Observation* observation_of(ast::File& tree, Channel const& channel) {
  if (ast::Model* const model = model_of(tree, channel))
    for (ast::ModelStatement& statement : model->statements)
      if (auto* const observation = std::get_if<ast::Observation>(&statement))
        if (covers(observation->span, channel.span)) return observation;
  return nullptr;
}

/// Where it is a factor or under a power.
std::string grouped(ast::Expression const& expression) {
  std::string text = unparse(expression);
  bool const word = std::ranges::all_of(text, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; });
  return word ? text : "(" + text + ")";
}

/// Whether a number without unit is the expression or a summand of it: its unit is then that of what surrounds the expression.
bool takes_unit_from_outside(ast::Expression const& expression) {
  if (auto const* const number = std::get_if<ast::Number>(&expression.node)) return !number->unit;
  if (auto const* const unary = std::get_if<ast::Box<ast::Unary>>(&expression.node))
    return takes_unit_from_outside(*(*unary)->operand);
  if (auto const* const binary = std::get_if<ast::Box<ast::Binary>>(&expression.node))
    return ((*binary)->symbol == "+" || (*binary)->symbol == "-") &&
           (takes_unit_from_outside(*(*binary)->left) || takes_unit_from_outside(*(*binary)->right));
  if (auto const* const branch = std::get_if<ast::Box<ast::Conditional>>(&expression.node))
    return takes_unit_from_outside(*(*branch)->then) || takes_unit_from_outside(*(*branch)->otherwise);
  if (auto const* const call = std::get_if<ast::Box<ast::Call>>(&expression.node))
    return std::ranges::any_of((*call)->arguments, [](ast::Argument const& each) { return takes_unit_from_outside(each.value); });
  return false;
}

/// The spread of normal noise, as it is written: an sd, a variance or a precision.
struct Spread {
  std::string as;
  ast::Expression const& value;

  std::string sd() const {
    if (as == "sd") return unparse(value);
    return as == "variance" ? fmt::format("sqrt({})", unparse(value)) : fmt::format("1/sqrt({})", unparse(value));
  }
  std::string variance() const {
    if (as == "sd") return grouped(value) + "^2";
    return as == "variance" ? grouped(value) : "1/" + grouped(value);
  }
};

/// The statement with another distribution in place of the one of that name: what `write` makes of its arguments, if anything.
template <typename Write>
std::optional<std::string> replaced(Source const& source, Channel const& channel, std::string_view distribution,
                                    Write const& write) {
  Diagnostics ignored;
  auto tree = parse(source, ignored);
  ast::Observation* const observation = tree ? observation_of(*tree, channel) : nullptr;
  if (observation == nullptr || observation->noise.function.text != distribution) return {};
  std::optional<std::string> const after = write(observation->noise);
  std::string const before = unparse(ast::Expression{{}, ast::Box<ast::Call>(observation->noise)});
  std::string text = unparse(ast::ModelStatement{*observation});
  std::size_t const at = text.find(before);
  return !after || at == text.npos ? std::nullopt : std::optional(text.replace(at, before.size(), *after));
}

/// The same of `normal(LOCATION, sd = SD)`: what `write` makes of location and spread.
template <typename Write>
std::optional<std::string> rewritten(Source const& source, Channel const& channel, Write const& write) {
  return replaced(source, channel, "normal", [&](ast::Call& noise) -> std::optional<std::string> {
    if (noise.arguments.size() != 2) return std::nullopt;
    ast::Argument const* const location = location_of(noise, *channel.noise.row);
    auto const spread = std::ranges::find_if(noise.arguments, [](ast::Argument const& each) {
      return each.name && (each.name->text == "sd" || each.name->text == "variance" || each.name->text == "precision");
    });
    if (location == nullptr || spread == noise.arguments.end() || location == &*spread) return std::nullopt;
    return write(location->value, Spread{spread->name->text, spread->value});
  });
}

}  // namespace

std::optional<std::string> noise_statement_with(Source const& source, Channel const& channel, std::string const& sum) {
  Diagnostics ignored;
  auto tree = parse(source, ignored);
  ast::Observation* const observation = tree ? observation_of(*tree, channel) : nullptr;
  if (observation == nullptr) return {};
  ast::Argument* const location = location_of(observation->noise, *channel.noise.row);
  if (location == nullptr) return {};
  ast::Reference added;
  added.name.text = sum;
  ast::Binary with_sum{{}, "+", std::move(location->value), ast::Expression{{}, std::move(added)}};
  location->value = ast::Expression{{}, std::move(with_sum)};
  return unparse(ast::ModelStatement{*observation});
}

TimeName time_name(Source const& source, Channel const& channel) {
  Diagnostics ignored;
  auto tree = parse(source, ignored);
  ast::Model const* const model = tree ? model_of(*tree, channel) : nullptr;
  if (model == nullptr) return {};
  for (ast::ModelStatement const& statement : model->statements)
    if (auto const* const time = std::get_if<ast::TimeDeclaration>(&statement)) return {time->time.name.text, true};
  std::string_view const text = std::string_view(source.text()).substr(model->span.begin, model->span.end - model->span.begin);
  return {free_name("t", [&](std::string const& name) { return mentions(text, name); })};
}

std::optional<std::string> heavy_tailed_statement(Source const& source, Channel const& channel) {
  return rewritten(source, channel, [](ast::Expression const& location, Spread const& spread) -> std::optional<std::string> {
    if (spread.as != "sd" && takes_unit_from_outside(spread.value)) return std::nullopt;
    return fmt::format("student_t({}, 4, scale = {})", unparse(location), spread.sd());
  });
}

std::optional<std::string> proportional_statement(Source const& source, Channel const& channel, std::string const& relative) {
  return rewritten(source, channel, [&](ast::Expression const& location, Spread const& spread) -> std::optional<std::string> {
    // Beside the squared location its unit would be that of the location, in place of the channel's.
    if (takes_unit_from_outside(spread.value)) return std::nullopt;
    return fmt::format("normal({}, sd = sqrt({} + ({}*{})^2))", unparse(location), spread.variance(), relative, grouped(location));
  });
}

std::optional<std::string> overdispersed_statement(Source const& source, Channel const& channel, std::string const& shape) {
  return replaced(source, channel, "poisson", [&](ast::Call& noise) -> std::optional<std::string> {
    ast::Argument const* const mean = location_of(noise, *channel.noise.row);
    if (mean == nullptr || noise.arguments.size() != 1) return std::nullopt;
    return fmt::format("negative_binomial({}, shape = {})", unparse(mean->value), shape);
  });
}

}  // namespace sysid
