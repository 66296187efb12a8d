// By what the name is in the model: each kind of statement has its own way to give a value.
#include "repl/work/assignment.hpp"

#include <fmt/format.h>

#include "repl/work/entry.hpp"
#include "syntax/entry.hpp"
#include "syntax/expression_text.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid::repl {
namespace {

enum class NameRole { nothing, state, valued, input };

/// What a name is in a model, and how its declaration begins.
struct NameDeclaration {
  NameRole role = NameRole::nothing;
  std::string head;
};

NameDeclaration declaration_of(ast::ModelStatement const& statement, std::string const& name) {
  return std::visit(
      [&](auto const& each) -> NameDeclaration {
        using Each = std::decay_t<decltype(each)>;
        if constexpr (std::is_same_v<Each, ast::InputDeclaration> || std::is_same_v<Each, ast::StateDeclaration>) {
          for (ast::Declared const& one : each.names)
            if (one.name.text == name) return {std::is_same_v<Each, ast::InputDeclaration> ? NameRole::input : NameRole::state, ""};
        } else if constexpr (std::is_same_v<Each, ast::ParameterDeclaration>) {
          if (each.name.name.text == name) return {NameRole::valued, "parameter " + text_of(each.name)};
        } else if constexpr (std::is_same_v<Each, ast::Definition>) {
          char const* const word = each.kind == ast::DefinitionKind::constant ? "constant "
                                   : each.kind == ast::DefinitionKind::local  ? "let "
                                                                              : "derive ";
          if (each.name.name.text == name) return {NameRole::valued, word + text_of(each.name)};
        } else if constexpr (std::is_same_v<Each, ast::DisturbanceDeclaration>) {
          if (each.name.name.text == name) return {NameRole::state, ""};  // the checker says what it cannot be
        }
        return {};
      },
      statement);
}

}  // namespace

std::optional<Diagnostic> assignment(WorkItem const& model, std::string const& entry, Span span) {
  ast::ModelStatement const typed = model_statement_of(entry.substr(span.begin, span.end - span.begin));
  auto const* equation = std::get_if<ast::Equation>(&typed);
  auto const* name = equation == nullptr ? nullptr : std::get_if<ast::Reference>(&equation->left.node);
  if (name == nullptr || name->primes > 0 || !name->index.empty() || name->name.text.find('.') != std::string::npos)
    return std::nullopt;
  ast::Item const item = item_of(model.text);
  auto const declared = [&](std::string const& wanted) {
    NameDeclaration last;
    for (ast::ModelStatement const& each : std::get<ast::Model>(item).statements)
      if (NameDeclaration found = declaration_of(each, wanted); found.role != NameRole::nothing) last = std::move(found);
    return last;
  };
  NameDeclaration const declaration = declared(name->name.text);
  // Terms may stand on either side: what moves on the right makes it an equation of motion.
  bool motion = declaration.role == NameRole::state;
  each_reference(equation->right, [&](ast::Reference const& each) {
    motion = motion || each.primes > 0 || declared(each.name.text).role == NameRole::state;
  });
  if (motion) return std::nullopt;
  std::string const value = unparse(equation->right);
  std::string help = fmt::format("write `{} = {}`", declaration.head, value);
  if (declaration.role == NameRole::input) help = "the values of an input are a column of the data block";
  if (declaration.role == NameRole::nothing)
    help = fmt::format("declare it: `let {0} = {1}`, or `parameter {0} = {1}`", name->name.text, value);
  return Diagnostic{Severity::error,
                    "",
                    fmt::format("this equation for `{}`, which is no state, would stand among those of the model", name->name.text),
                    Label{span, {}},
                    {},
                    std::move(help)};
}

}  // namespace sysid::repl
