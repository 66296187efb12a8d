// By the tree of the user's text, which is parsed once more: the checked model has no words.
#include "experiment/noise_statement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "core/text/diagnostic.hpp"
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

/// A model of the text and the statement in it that observes the channel; null where it stands in a module.
ast::Observation* observation_of(ast::File& tree, Channel const& channel) {
  for (ast::Item& item : tree.items) {
    auto* const model = std::get_if<ast::Model>(&item);
    if (model == nullptr || !covers(model->span, channel.span)) continue;
    for (ast::ModelStatement& statement : model->statements)
      if (auto* const observation = std::get_if<ast::Observation>(&statement))
        if (covers(observation->span, channel.span)) return observation;
  }
  return nullptr;
}

/// Where it is a factor or under a power.
std::string grouped(ast::Expression const& expression) {
  std::string text = unparse(expression);
  bool const word = std::ranges::all_of(text, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; });
  return word ? text : "(" + text + ")";
}

/// The statement with another distribution in place of `normal(LOCATION, sd = SD)`: what `write` makes of the two.
template <typename Write>
std::optional<std::string> rewritten(Source const& source, Channel const& channel, Write const& write) {
  Diagnostics ignored;
  auto tree = parse(source, ignored);
  ast::Observation* const observation = tree ? observation_of(*tree, channel) : nullptr;
  if (observation == nullptr || observation->noise.function.text != "normal" || observation->noise.arguments.size() != 2) return {};
  ast::Argument const* const location = location_of(observation->noise, *channel.noise.row);
  auto const sd = std::ranges::find_if(observation->noise.arguments,
                                       [](ast::Argument const& each) { return each.name && each.name->text == "sd"; });
  if (location == nullptr || sd == observation->noise.arguments.end() || location == &*sd) return {};
  std::string const before = unparse(ast::Expression{{}, ast::Box<ast::Call>(observation->noise)});
  std::string text = unparse(ast::ModelStatement{*observation});
  std::size_t const at = text.find(before);
  return at == text.npos ? std::nullopt : std::optional(text.replace(at, before.size(), write(location->value, sd->value)));
}

}  // namespace

bool mentions(Source const& source, std::string_view name) {
  std::string_view const text = source.text();
  auto const belongs = [&](std::size_t at) {
    return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_');
  };
  for (std::size_t at = text.find(name); at != std::string_view::npos; at = text.find(name, at + 1))
    if (!(at > 0 && belongs(at - 1)) && !belongs(at + name.size())) return true;
  return false;
}

std::optional<std::string> noise_statement_with(Source const& source, Channel const& channel, std::string const& parameter) {
  Diagnostics ignored;
  auto tree = parse(source, ignored);
  ast::Observation* const observation = tree ? observation_of(*tree, channel) : nullptr;
  if (observation == nullptr) return {};
  ast::Argument* const location = location_of(observation->noise, *channel.noise.row);
  if (location == nullptr) return {};
  ast::Reference added;
  added.name.text = parameter;
  ast::Binary sum{{}, "+", std::move(location->value), ast::Expression{{}, std::move(added)}};
  location->value = ast::Expression{{}, std::move(sum)};
  return unparse(ast::ModelStatement{*observation});
}

std::optional<std::string> heavy_tailed_statement(Source const& source, Channel const& channel) {
  return rewritten(source, channel, [](ast::Expression const& location, ast::Expression const& sd) {
    return fmt::format("student_t({}, 4, scale = {})", unparse(location), unparse(sd));
  });
}

std::optional<std::string> proportional_statement(Source const& source, Channel const& channel, std::string const& relative) {
  // A bare number as sd takes the unit of the channel; beside the squared location it would take that of the location.
  bool bare = false;
  (void)rewritten(source, channel, [&](ast::Expression const&, ast::Expression const& sd) {
    std::string const text = unparse(sd);
    bare = std::ranges::none_of(text, [](unsigned char c) { return std::isalpha(c) != 0; });
    return text;
  });
  if (bare) return std::nullopt;
  return rewritten(source, channel, [&](ast::Expression const& location, ast::Expression const& sd) {
    return fmt::format("normal({}, sd = sqrt({}^2 + ({}*{})^2))", unparse(location), grouped(sd), relative, grouped(location));
  });
}

}  // namespace sysid
