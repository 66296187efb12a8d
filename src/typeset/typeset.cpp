// A statement is a left side, a sign and a right side, or some of them.
#include "typeset/typeset.hpp"

#include <fmt/format.h>

#include <vector>

#include "core/text/source.hpp"
#include "core/text/xml.hpp"
#include "syntax/expression_text.hpp"
#include "syntax/parse.hpp"
#include "typeset/formula.hpp"

namespace sysid {

namespace {

struct Relation {
  std::string left;
  Sign sign;
  std::string right;
};

/// What a statement says, one relation each; none: it is no formula.
class Relations {
 public:
  explicit Relations(Notation const& notation) : to_(notation), formula_(notation, symbols_) {}

  std::vector<Relation> operator()(ast::ModelStatement const& statement) const {
    return std::visit([&](auto const& each) { return (*this)(each); }, statement);
  }
  /// Of statements of one model, in their order: names that would be printed alike are told apart.
  std::vector<std::vector<Relation>> operator()(std::vector<ast::ModelStatement> const& statements) const {
    std::vector<std::vector<Relation>> out;
    for (ast::ModelStatement const& statement : statements) (*this)(statement);  // makes all names known
    for (ast::ModelStatement const& statement : statements) out.push_back((*this)(statement));
    return out;
  }

 private:
  std::vector<Relation> operator()(ast::TimeDeclaration const&) const { return {}; }
  std::vector<Relation> operator()(ast::DiscreteTimeDeclaration const&) const { return {}; }
  std::vector<Relation> operator()(ast::InputDeclaration const&) const { return {}; }
  std::vector<Relation> operator()(ast::StateDeclaration const&) const { return {}; }
  std::vector<Relation> operator()(ast::Part const&) const { return {}; }
  std::vector<Relation> operator()(ast::InitialDeclaration const& declaration) const {
    std::vector<Relation> out;
    for (ast::InitialValue const& each : declaration.values) {
      std::string const left = to_.row({formula_(each.state), to_.fenced(Fence::parentheses, to_.digits("0"))});
      if (each.law) out.push_back({left, Sign::distributed, formula_.distribution(*each.law)});
      if (each.value) out.push_back({left, Sign::equal, formula_(*each.value)});
    }
    return out;
  }
  std::vector<Relation> operator()(ast::DisturbanceDeclaration const& disturbance) const {
    return {{formula_.name(disturbance.name.name.text), Sign::distributed,
             with_unit(formula_.distribution(disturbance.law), disturbance.name.unit)}};
  }
  std::vector<Relation> operator()(ast::ParameterDeclaration const& parameter) const {
    std::string const left = formula_.name(parameter.name.name.text);
    if (parameter.prior)
      return {{left, Sign::distributed, with_unit(formula_.distribution(*parameter.prior), parameter.name.unit)}};
    if (parameter.value) return {{left, Sign::equal, with_unit(formula_(*parameter.value), parameter.name.unit)}};
    return {};
  }
  std::vector<Relation> operator()(ast::Definition const& definition) const {
    return {{formula_.name(definition.name.name.text), Sign::equal, with_unit(formula_(definition.value), definition.name.unit)}};
  }
  std::vector<Relation> operator()(ast::FunctionDefinition const& function) const {
    return {{applied(function.name, function.parameters), Sign::equal, formula_(function.value)}};
  }
  std::vector<Relation> operator()(ast::ProcessDefinition const& process) const {
    return {{applied(process.name, process.inputs), Sign::distributed, formula_.distribution(process.process)}};
  }
  std::vector<Relation> operator()(ast::Observation const& observation) const {
    return {{formula_.name(observation.channel.name.text), Sign::distributed, formula_.distribution(observation.noise)}};
  }
  std::vector<Relation> operator()(ast::Equation const& equation) const {
    return {{formula_(equation.left), Sign::equal, formula_(equation.right)}};
  }

  std::string with_unit(std::string const& value, std::optional<ast::UnitExpression> const& unit) const {
    if (!unit || unparse(*unit) == "-") return value;
    return to_.row({value, to_.thin_space(), to_.fenced(Fence::brackets, formula_.unit(*unit))});
  }
  /// f(u, v) of names alone.
  std::string applied(ast::Name const& function, std::vector<ast::Name> const& inputs) const {
    ast::Call call;
    call.function = function;
    for (ast::Name const& input : inputs) {
      ast::Reference reference;
      reference.name = input;
      call.arguments.emplace_back().value.node = std::move(reference);
    }
    return formula_.call(call);
  }

  Notation const& to_;
  Symbols symbols_;
  Formula formula_;
};

/// A list of values, `initial y = 0, y' = 0`, stands in one line.
std::string in_line(std::vector<Relation> const& relations, Notation const& to) {
  std::vector<std::string> pieces;
  for (Relation const& relation : relations) {
    if (!pieces.empty()) pieces.push_back(to.sign(Sign::comma));
    pieces.insert(pieces.end(), {relation.left, to.sign(relation.sign), relation.right});
  }
  return to.row(pieces);
}

}  // namespace

bool has_formula(ast::ModelStatement const& statement) { return !Relations(latex_notation())(statement).empty(); }

std::vector<std::optional<std::string>> mathml(std::vector<ast::ModelStatement> const& statements) {
  Notation const& to = mathml_notation();
  std::vector<std::optional<std::string>> out;
  auto const all = Relations(to)(statements);
  for (std::size_t i = 0; i < statements.size(); ++i) {
    out.emplace_back();
    if (!all[i].empty())
      out.back() =
          fmt::format("<math display=\"block\" alttext=\"{}\">{}</math>", escape(unparse(statements[i])), in_line(all[i], to));
  }
  return out;
}

std::optional<ast::ModelStatement> model_statement(std::string_view text) {
  Diagnostics ignored;
  Source const source("", fmt::format("model m {{\n{}\n}}\n", text));
  std::optional<ast::File> const file = parse(source, ignored);
  if (!file || file->items.size() != 1) return std::nullopt;
  auto const* model = std::get_if<ast::Model>(&file->items.front());
  if (model == nullptr || model->statements.size() != 1) return std::nullopt;
  return model->statements.front();
}

std::vector<std::string> formulas(std::vector<std::string> const& statements) {
  std::vector<std::string> out(statements.size());
  std::vector<ast::ModelStatement> trees;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < statements.size(); ++i)
    if (auto tree = model_statement(statements[i])) {
      trees.push_back(std::move(*tree));
      places.push_back(i);
    }
  std::vector<std::optional<std::string>> const displayed = mathml(trees);
  for (std::size_t i = 0; i < displayed.size(); ++i)
    if (displayed[i]) out[places[i]] = *displayed[i];
  return out;
}

std::string mathml(ast::Expression const& expression) {
  Symbols symbols;
  Formula const formula(mathml_notation(), symbols);
  (void)formula(expression);  // makes all names known
  return fmt::format("<math alttext=\"{}\">{}</math>", escape(unparse(expression)), formula(expression));
}

std::string latex(ast::Model const& model) {
  Notation const& to = latex_notation();
  std::string lines;
  for (std::vector<Relation> relations : Relations(to)(model.statements)) {
    if (relations.empty()) continue;
    relations.front().left += " &";
    lines += fmt::format("{}  {}", lines.empty() ? "" : " \\\\\n", in_line(relations, to));
  }
  return lines.empty() ? std::string() : fmt::format("\\begin{{align*}}\n{}\n\\end{{align*}}\n", lines);
}

std::string latex(ast::File const& file) {
  std::string text;
  for (ast::Item const& item : file.items)
    if (auto const* model = std::get_if<ast::Model>(&item)) text += fmt::format("% {}\n{}\n", model->name.text, latex(*model));
  return text;
}

}  // namespace sysid
