// Read from the syntax tree: nothing of it depends on the parameters that are estimated.
#include "typeset/fixed_values.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/text/source.hpp"
#include "syntax/parse.hpp"
#include "syntax/unparse.hpp"

namespace sysid {

namespace {

template <class Block>
Block const* find_block(ast::File const& file, std::string_view name) {
  for (ast::Item const& item : file.items)
    if (auto const* block = std::get_if<Block>(&item); block != nullptr && block->name.text == name) return block;
  return nullptr;
}

/// What the block says the parameter is.
ast::Expression const* constant_of(ast::Data const& data, std::string_view parameter) {
  for (ast::DataStatement const& statement : data.statements)
    if (auto const* constant = std::get_if<ast::DataConstant>(&statement);
        constant != nullptr && constant->parameter.text == parameter)
      return &constant->value;
  return nullptr;
}

/// `unit`: of a number that is written without one.
FixedValue fixed_value(std::string name, ast::Expression const& value, std::optional<ast::UnitExpression> const& unit) {
  auto const* number = std::get_if<ast::Number>(&value.node);
  if (number != nullptr && number->unit) {
    ast::Number bare = *number;
    bare.unit.reset();
    return {std::move(name), unparse(ast::Expression{{}, bare}), unparse(*number->unit)};
  }
  return {std::move(name), unparse(value), unit ? unparse(*unit) : std::string()};
}

}  // namespace

std::vector<FixedValue> fixed_values(std::string_view text, std::string_view model, std::vector<std::string> const& data) {
  Diagnostics ignored;
  Source const source("", std::string(text));
  std::optional<ast::File> const file = parse(source, ignored);
  ast::Model const* block = file ? find_block<ast::Model>(*file, model) : nullptr;
  std::vector<FixedValue> out;
  if (block == nullptr) return out;
  for (ast::ModelStatement const& statement : block->statements) {
    auto const* parameter = std::get_if<ast::ParameterDeclaration>(&statement);
    if (parameter == nullptr) continue;
    std::string const& name = parameter->name.name.text;
    if (!parameter->name.per_experiment) {
      if (parameter->value) out.push_back(fixed_value(name, *parameter->value, parameter->name.unit));
      continue;
    }
    for (std::string const& each : data) {
      ast::Data const* record = find_block<ast::Data>(*file, each);
      ast::Expression const* value = record == nullptr ? nullptr : constant_of(*record, name);
      // Of a record that the text does not have nobody knows whether it says otherwise.
      if (value == nullptr && record != nullptr && parameter->value) value = &*parameter->value;
      if (value != nullptr) out.push_back(fixed_value(fmt::format("{}[{}]", name, each), *value, parameter->name.unit));
    }
  }
  return out;
}

}  // namespace sysid
