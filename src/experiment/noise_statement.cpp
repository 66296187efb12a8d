// By the tree of the user's text, which is parsed once more: the checked model has no words.
#include "experiment/noise_statement.hpp"

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
  if (!tree) return {};
  for (ast::Item& item : tree->items) {
    auto* const model = std::get_if<ast::Model>(&item);
    if (model == nullptr || !covers(model->span, channel.span)) continue;
    for (ast::ModelStatement& statement : model->statements) {
      auto* const observation = std::get_if<ast::Observation>(&statement);
      if (observation == nullptr || !covers(observation->span, channel.span)) continue;
      ast::Argument* const location = location_of(observation->noise, *channel.noise.row);
      if (location == nullptr) return {};
      ast::Reference added;
      added.name.text = parameter;
      ast::Binary sum{{}, "+", std::move(location->value), ast::Expression{{}, std::move(added)}};
      location->value = ast::Expression{{}, std::move(sum)};
      return unparse(statement);
    }
  }
  return {};
}

}  // namespace sysid
