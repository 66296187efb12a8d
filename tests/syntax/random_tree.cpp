// Random trees: every node, every option, names that are words of the language among them.
#include "random_tree.hpp"

#include <array>

#include "syntax/words.hpp"

namespace sysid::test {

namespace {

// Without with, to, on, from: at the end of a line between blocks they would continue it.
constexpr std::array names{"y",    "x",   "alpha", "k3",     "_",    "input", "state", "model", "data",
                           "time", "fit", "rows",  "shared", "hold", "let",   "σ_ε",   "inf"};
constexpr std::array units{"N", "m", "kg", "µm", "1", "%", "degC"};
constexpr std::array texts{"", "duffing.csv", "two\nlines", "a \"quoted\" \\ word", "# no comment", "Größe × 2", "y", "if", "1st"};
constexpr std::array symbols{"+", "-", "*", "/", "^", "<", "<=", ">", ">=", "==", "!=", "and", "or"};

}  // namespace

ast::Name RandomTree::name() { return {{}, random_.pick(names)}; }
ast::Text RandomTree::text() { return {{}, random_.pick(texts)}; }

double RandomTree::value() {
  constexpr std::array values{0.0, 1.0, 2.5, 0.1, 1e-4, 1e300, 5e-324, 123456789.0, 1.0 / 3.0, 25000.0};
  return random_.chance(4) ? static_cast<double>(random_.below(1U << 30U)) / 1024.0 * 1e-7 : random_.pick(values);
}

ast::Reference RandomTree::reference(int depth) {
  ast::Reference out{{}, name(), {}, static_cast<int>(random_.below(3))};
  if (random_.chance(6)) out.name.text += "." + name().text;
  if (depth > 0 && random_.chance(4)) out.index = several(1, [&] { return expression(depth - 1); });
  return out;
}

ast::Number RandomTree::number(int depth) {
  ast::Number out{{}, value(), {}};
  if (depth > 0 && random_.chance(3)) out.unit = unit(depth - 1);
  return out;
}

ast::UnitExpression RandomTree::unit(int depth) {
  if (random_.chance(8)) return {{}, {{{}, ast::Name{{}, "-"}, {}, false}}};
  ast::UnitExpression out{
      {}, several(1, [&] {
        ast::UnitFactor factor{{}, ast::Name{{}, random_.pick(units)}, {}, random_.chance(2)};
        if (depth > 0 && random_.chance(4)) {
          ast::UnitExpression group = unit(depth - 1);
          if (std::get_if<ast::Name>(&group.factors[0].base) == nullptr || std::get<ast::Name>(group.factors[0].base).text != "-")
            factor.base = ast::Box(std::move(group));
        }
        if (random_.chance(3)) factor.exponent = ast::Box(expression(depth > 0 ? depth - 1 : 0));
        return factor;
      })};
  out.factors[0].reciprocal = false;
  return out;
}

ast::Call RandomTree::call(int depth) {
  auto const value = [&]() -> ast::Expression {
    if (random_.chance(6)) return {{}, ast::Box(ast::Binary{{}, "..", expression(depth - 1), expression(depth - 1)})};
    return expression(depth - 1);
  };
  return {{}, name(), several(0, [&] { return ast::Argument{{}, perhaps([&] { return name(); }), value()}; })};
}

ast::Expression RandomTree::expression(int depth) {
  switch (depth <= 0 ? random_.below(3) : random_.below(12)) {
    case 0:
      return {{}, number(depth)};
    case 1:
      return {{}, reference(depth)};
    case 2:
      return {{}, random_.chance(4) ? decltype(ast::Expression::node)(text()) : decltype(ast::Expression::node)(reference())};
    case 3:
      return {{}, ast::Box(ast::Unary{{}, random_.chance(3) ? "not" : "-", expression(depth - 1)})};
    case 4:
      return {{}, ast::Box(call(depth))};
    case 5:
      return {{}, ast::Box(ast::Conditional{{}, expression(depth - 1), expression(depth - 1), expression(depth - 1)})};
    case 6:
      return {{}, ast::Box(ast::List{{}, several(2, [&] { return expression(depth - 1); })})};
    default:
      return {{}, ast::Box(ast::Binary{{}, random_.pick(symbols), expression(depth - 1), expression(depth - 1)})};
  }
}

ast::Declared RandomTree::declared() {
  return {{},
          name(),
          random_.chance(4) ? several(1, [&] { return expression(1); }) : std::vector<ast::Expression>(),
          false,
          perhaps([&] { return unit(1); })};
}
ast::Column RandomTree::column() {
  return {{}, random_.chance(2) ? name().text : text().value, perhaps([&] { return unit(1); })};
}
ast::FunctionDefinition RandomTree::function() {
  return {{}, name(), several(0, [&] { return name(); }), expression(2)};
}

ast::ModelStatement RandomTree::model_statement() {
  constexpr std::array kinds{ast::DefinitionKind::constant, ast::DefinitionKind::local, ast::DefinitionKind::derived};
  switch (random_.below(13)) {
    case 12:
      return ast::DisturbanceDeclaration{{}, declared(), call(2)};
    case 11:
      return ast::ProcessDefinition{{}, name(), several(1, [&] { return name(); }), call(2)};
    case 9:
      return ast::DiscreteTimeDeclaration{{}, perhaps([&] { return ast::Expression{{}, number(1)}; })};
    case 10:
      return ast::Part{{}, name(), call(2)};
    case 0:
      return ast::TimeDeclaration{{}, declared()};
    case 1:
      return ast::InputDeclaration{{}, several(1, [&] { return declared(); })};
    case 2:
      return ast::StateDeclaration{{}, several(1, [&] { return declared(); })};
    case 3:
      return ast::InitialDeclaration{{}, several(1, [&] {
                                       ast::InitialValue value{{}, reference(), {}, {}};
                                       if (random_.chance(3))
                                         value.law = call(2);
                                       else
                                         value.value = expression(2);
                                       return value;
                                     })};
    case 4: {
      ast::ParameterDeclaration out{{}, declared(), {}, {}};
      out.name.per_experiment = random_.chance(3);
      if (random_.chance(2))
        out.prior = call(2);
      else
        out.value = perhaps([&] { return expression(2); });
      return out;
    }
    case 5:
      return ast::Definition{{}, random_.pick(kinds), declared(), expression(3)};
    case 6:
      return function();
    case 7:
      return ast::Observation{{}, declared(), call(2)};
    default:
      return ast::Equation{{}, expression(4), expression(3)};
  }
}

ast::DataStatement RandomTree::data_statement() {
  switch (random_.below(8)) {
    case 6: {
      auto const item = [&] {
        return random_.chance(2) ? ast::ReadingItem{{}, text().value, true} : ast::ReadingItem{{}, name().text};
      };
      return ast::DataReading{{}, several(1, [&] {
                                auto setting = ast::ReadingSetting{{}, name(), several(1, item)};
                                setting.range = setting.items.size() == 2 && random_.chance(2);
                                return setting;
                              })};
    }
    case 5:
      return ast::DataConstant{{}, name(), expression(2)};
    case 0:
      return ast::DataFile{{}, text()};
    case 1:
      return ast::DataTime{{}, column()};
    case 2:
      return ast::DataRate{{}, random_.chance(2), expression(2)};
    case 3:
      return ast::DataInput{{}, name(), column(), perhaps([&] { return name(); }), perhaps([&] { return call(2); })};
    case 4:
      return ast::DataMeasure{{}, name(), column()};
    default:
      return ast::DataSplit{{}, several(1, [&] { return ast::SplitPart{{}, name(), expression(1), expression(1)}; })};
  }
}

ast::CandidateStatement RandomTree::candidate_statement() {
  if (random_.chance(4)) return ast::SharedParameters{{}, several(1, [&] { return name(); })};
  return ast::Candidate{{}, name(), call(2).arguments, perhaps([&] { return expression(2); })};
}

ast::DictionaryStatement RandomTree::dictionary_statement() {
  constexpr std::array kinds{ast::DictionaryListKind::target, ast::DictionaryListKind::terms, ast::DictionaryListKind::exclude};
  auto const quantity = [&] { return ast::Declared{{}, name(), {}, false, perhaps([&] { return unit(1); })}; };
  switch (random_.below(8)) {
    case 0:
      return ast::TimeDeclaration{{}, quantity()};
    case 1:
      return ast::InputDeclaration{{}, several(1, quantity)};
    case 2:
      return ast::DictionaryStates{
          {}, several(1, [&] {
            return ast::DictionaryState{
                {}, name(), static_cast<int>(random_.below(3)), perhaps([&] { return unit(1); }), perhaps([&] { return name(); })};
          })};
    case 3:
      if (random_.chance(3)) return ast::DictionaryParameter{{}, quantity(), call(2), {}};
      return ast::DictionaryParameter{{}, quantity(), {}, perhaps([&] { return expression(2); })};
    case 4:
      return ast::Definition{
          {}, random_.chance(2) ? ast::DefinitionKind::constant : ast::DefinitionKind::local, quantity(), expression(3)};
    case 5:
      return function();
    case 6:
      return ast::CoefficientUnits{{}, several(1, [&] { return unit(1); })};
    default:
      return ast::DictionaryList{{}, random_.pick(kinds), several(1, [&] { return expression(3); })};
  }
}

ast::Task RandomTree::task() {
  ast::Task out{{}, perhaps([&] { return name(); }), {{}, std::string(random_.pick(words::verbs))}, name(), {}, {}, {}, {}, {}};
  if (random_.chance(3))
    out.arguments = several(1, [&] { return ast::Argument{{}, perhaps([&] { return name(); }), expression(1)}; });
  if (out.verb.text == "predict") out.others = several(0, [&] { return name(); });
  if (random_.chance(2)) {
    out.preposition = ast::Name{{}, std::string(random_.pick(words::prepositions))};
    out.data = several(1, [&] { return ast::DataReference{{}, name(), perhaps([&] { return name(); })}; });
  }
  out.options = several(0, [&] {
    ast::Option option{{}, random_.chance(3), perhaps([&] { return name(); }), expression(2)};
    if (option.input && !option.key) option.key = name();
    return option;
  });
  return out;
}

ast::File RandomTree::file() {
  ast::File out;
  out.items = several(0, [&]() -> ast::Item {
    switch (random_.below(7)) {
      case 5:
        return ast::Dictionary{{}, name(), perhaps([&] { return text(); }), several(0, [&] { return dictionary_statement(); })};
      case 4:
        return ast::Candidates{{}, name(), perhaps([&] { return text(); }), several(0, [&] { return candidate_statement(); })};
      case 3:
        return ast::Use{{}, name()};
      case 0:
        return ast::Data{{}, name(), several(0, [&] { return data_statement(); })};
      case 1:
        return function();
      case 2:
        return task();
      default:
        return ast::Model{{},
                          name(),
                          several(0,
                                  [&] {
                                    return ast::ModelArgument{{}, name(), perhaps([&] { return expression(1); })};
                                  }),
                          perhaps([&] { return text(); }),
                          several(0, [&] { return model_statement(); })};
    }
  });
  return out;
}

}  // namespace sysid::test
