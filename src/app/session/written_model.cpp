// Found by its name in the flat tree, by its place in the tree as written.
#include "app/session/written_model.hpp"

#include <algorithm>
#include <set>

#include "core/text/without_index.hpp"
#include "syntax/find_model.hpp"
#include "syntax/parse.hpp"
#include "syntax/walk.hpp"

namespace sysid {

ast::Model const* as_written(ast::File const& tree, Span span) {
  for (ast::Item const& item : tree.items)
    if (auto const* model = std::get_if<ast::Model>(&item); model != nullptr && model->span == span) return model;
  return nullptr;
}

std::function<bool(std::string const& parameter)> switched_off_by_arguments(Session const& session, std::string const& model) {
  ast::Model const* const flat = find_model(session.file.tree, model);
  if (flat == nullptr || model.find('(') == std::string::npos) return nullptr;
  Diagnostics ignored;
  auto const tree = parse(session.source, ignored);
  ast::Model const* const written = tree ? as_written(*tree, flat->span) : nullptr;
  if (written == nullptr) return [](std::string const&) { return true; };
  std::set<std::string> read;
  for (ast::ModelStatement const& statement : written->statements)
    each_reference(statement, [&](ast::Reference const& reference) { read.insert(reference.name.text); });
  return [read = std::move(read)](std::string const& parameter) {
    bool const of_part = parameter.find('.') != std::string::npos;
    return of_part || read.contains(parameter) || read.contains(without_index(parameter));
  };
}

}  // namespace sysid
