// The model of a name in a file.
#pragma once
#include <string_view>
#include <variant>

#include "syntax/ast.hpp"

namespace sysid {

/// Null where the file has no such model.
inline ast::Model const* find_model(ast::File const& tree, std::string_view name) {
  for (ast::Item const& item : tree.items)
    if (auto const* model = std::get_if<ast::Model>(&item); model != nullptr && model->name.text == name) return model;
  return nullptr;
}

}  // namespace sysid
