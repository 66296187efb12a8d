// Canonical text: one statement a line, two blanks of indentation in blocks, the fewest parentheses that keep the tree.
#include "syntax/unparse.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>

#include "core/diagnostic.hpp"
#include "syntax/words.hpp"

namespace sysid {

namespace {

/// How tightly an expression holds together, loosest first; an operand looser than its place wants is put in parentheses.
enum class Binding { conditional, disjunction, conjunction, negation, comparison, sum, product, sign, power, primary };

struct OperatorRow {
  std::string_view symbol;
  Binding binding, left, right;
};
/// sysid.ebnf's levels. The right operand of `^` may carry a sign; comparisons do not associate.
constexpr std::array<OperatorRow, 14> operators{{
    {"..", Binding::conditional, Binding::conditional, Binding::conditional},  // of arguments alone
    {"or", Binding::disjunction, Binding::disjunction, Binding::conjunction},
    {"and", Binding::conjunction, Binding::conjunction, Binding::negation},
    {"<", Binding::comparison, Binding::sum, Binding::sum},
    {"<=", Binding::comparison, Binding::sum, Binding::sum},
    {">", Binding::comparison, Binding::sum, Binding::sum},
    {">=", Binding::comparison, Binding::sum, Binding::sum},
    {"==", Binding::comparison, Binding::sum, Binding::sum},
    {"!=", Binding::comparison, Binding::sum, Binding::sum},
    {"+", Binding::sum, Binding::sum, Binding::product},
    {"-", Binding::sum, Binding::sum, Binding::product},
    {"*", Binding::product, Binding::product, Binding::sign},
    {"/", Binding::product, Binding::product, Binding::sign},
    {"^", Binding::power, Binding::primary, Binding::sign},
}};

OperatorRow const& row_of(std::string_view symbol) {
  for (OperatorRow const& row : operators)
    if (row.symbol == symbol) return row;
  throw InternalError(fmt::format("no operator `{}` to print", symbol));
}

/// The shortest digits that read back as the same number; 1e-4 rather than 1e-04.
std::string number_text(double value) {
  std::array<char, 32> buffer{};
  auto const end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  std::string text(buffer.data(), end);
  std::size_t const e = text.find('e');
  if (e == std::string::npos) return text;
  std::string const sign = text[e + 1] == '-' ? "-" : "";
  std::size_t const digits = text.find_first_not_of("+-0", e + 1);
  return text.substr(0, e + 1) + sign + text.substr(digits);
}

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (char const c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return out + '"';
}

template <class Items, class Print>
std::string joined(Items const& items, std::string_view separator, Print print) {
  std::string out;
  for (auto const& item : items) {
    if (&item != &items.front()) out += separator;
    out += print(item);
  }
  return out;
}

std::string bracketed(std::optional<ast::UnitExpression> const& unit) { return unit ? fmt::format(" [{}]", unparse(*unit)) : ""; }

std::string text_of(ast::Call const& call);
std::string text_of(ast::Reference const& reference);

/// `leading`: nothing stands before the expression in its statement, and no statement begins with a sign.
class Printer {
 public:
  explicit Printer(bool leading = false) : leading_(leading) {}

  std::string operator()(ast::Expression const& expression, Binding place) const {
    bool const parentheses = binding(expression) < place || (leading_ && binding(expression) == Binding::sign);
    if (parentheses) return fmt::format("({})", Printer()(expression, Binding::conditional));
    return std::visit([&](auto const& node) { return (*this)(node); }, expression.node);
  }

 private:
  static Binding binding(ast::Expression const& expression) {
    struct Visitor {
      Binding operator()(ast::Number const& number) const { return std::signbit(number.value) ? Binding::sign : Binding::primary; }
      Binding operator()(ast::Text const&) const { return Binding::primary; }
      Binding operator()(ast::Reference const&) const { return Binding::primary; }
      Binding operator()(ast::Box<ast::Unary> const& unary) const {
        return unary->symbol == "not" ? Binding::negation : Binding::sign;
      }
      Binding operator()(ast::Box<ast::Binary> const& binary) const { return row_of(binary->symbol).binding; }
      Binding operator()(ast::Box<ast::Call> const&) const { return Binding::primary; }
      Binding operator()(ast::Box<ast::Conditional> const&) const { return Binding::conditional; }
      Binding operator()(ast::Box<ast::List> const&) const { return Binding::primary; }
    };
    return std::visit(Visitor{}, expression.node);
  }

  std::string operator()(ast::Number const& number) const { return number_text(number.value) + bracketed(number.unit); }
  std::string operator()(ast::Text const& text) const { return quoted(text.value); }
  std::string operator()(ast::Reference const& reference) const { return text_of(reference); }
  std::string operator()(ast::Box<ast::Unary> const& unary) const {
    if (unary->symbol == "not") return "not " + Printer()(*unary->operand, Binding::negation);
    return unary->symbol + Printer()(*unary->operand, Binding::sign);
  }
  std::string operator()(ast::Box<ast::Binary> const& binary) const {
    OperatorRow const& row = row_of(binary->symbol);
    bool const tight = row.binding >= Binding::product || binary->symbol == "..";
    return fmt::format("{}{}{}{}{}", (*this)(*binary->left, row.left), tight ? "" : " ", binary->symbol, tight ? "" : " ",
                       Printer()(*binary->right, row.right));
  }
  std::string operator()(ast::Box<ast::Call> const& call) const { return text_of(*call); }
  std::string operator()(ast::Box<ast::Conditional> const& conditional) const {
    Printer const print;
    return fmt::format("if {} then {} else {}", print(*conditional->condition, Binding::conditional),
                       print(*conditional->then, Binding::conditional), print(*conditional->otherwise, Binding::conditional));
  }
  std::string operator()(ast::Box<ast::List> const& list) const {
    return fmt::format("({})", joined(list->items, ", ", [](ast::Expression const& item) { return unparse(item); }));
  }

  bool leading_;
};

std::string parenthesised(std::vector<ast::Expression> const& items) {
  return items.empty() ? "" : fmt::format("({})", joined(items, ", ", [](auto const& item) { return unparse(item); }));
}

std::string text_of(ast::Reference const& reference) {
  std::string out = reference.name.text;
  if (!reference.index.empty())
    out += fmt::format("[{}]", joined(reference.index, ", ", [](auto const& item) { return unparse(item); }));
  return out + std::string(static_cast<std::size_t>(reference.primes), '\'');
}

std::string text_of(ast::Declared const& declared) {
  return declared.name.text + parenthesised(declared.sizes) + (declared.per_experiment ? " per experiment" : "") +
         bracketed(declared.unit);
}

std::string text_of(ast::Argument const& argument) {
  return argument.name ? fmt::format("{} = {}", argument.name->text, unparse(argument.value)) : unparse(argument.value);
}

std::string text_of(ast::Call const& call) {
  return fmt::format("{}({})", call.function.text,
                     joined(call.arguments, ", ", [](ast::Argument const& argument) { return text_of(argument); }));
}

/// Behind the `^` of a unit: a number, a name, either with a sign, or anything in parentheses.
std::string exponent_text(ast::Expression const& exponent) {
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&exponent.node); unary != nullptr && (*unary)->symbol == "-") {
    ast::Expression const& operand = *(*unary)->operand;
    bool const simple = !std::holds_alternative<ast::Box<ast::Unary>>(operand.node);
    return "-" + (simple ? exponent_text(operand) : fmt::format("({})", unparse(operand)));
  }
  auto const* number = std::get_if<ast::Number>(&exponent.node);
  bool const simple = (number != nullptr && !number->unit) || std::holds_alternative<ast::Reference>(exponent.node);
  return simple ? unparse(exponent) : fmt::format("({})", unparse(exponent));
}

std::string text_of(ast::UnitFactor const& factor) {
  auto const* name = std::get_if<ast::Name>(&factor.base);
  std::string out =
      name != nullptr ? name->text : fmt::format("({})", unparse(*std::get<ast::Box<ast::UnitExpression>>(factor.base)));
  if (factor.exponent) out += "^" + exponent_text(**factor.exponent);
  return out;
}

std::string text_of(ast::Name const& name) { return name.text; }

std::string text_of(ast::InitialValue const& value) { return fmt::format("{} = {}", text_of(value.state), unparse(value.value)); }

std::string text_of(ast::Option const& option) {
  std::string const key = option.key ? option.key->text + " = " : "";
  return (option.input ? "input " : "") + key + unparse(option.value);
}

std::string text_of(ast::ModelArgument const& argument) {
  return argument.name.text + (argument.value ? " = " + unparse(*argument.value) : "");
}

std::string text_of(ast::DataReference const& reference) {
  return reference.data.text + (reference.part ? "." + reference.part->text : "");
}

std::string text_of(ast::DictionaryState const& state) {
  return state.name.text + std::string(static_cast<std::size_t>(state.primes), '\'') + bracketed(state.unit) +
         (state.channel ? " = " + state.channel->text : "");
}

template <class Items>
std::string comma_list(Items const& items) {
  return joined(items, ", ", [](auto const& item) { return text_of(item); });
}

bool is_plain_identifier(std::string_view text) {
  bool plain = !text.empty() && words::begins_name(text[0]) && !words::contains(words::reserved, text);
  // Outside ASCII some characters are refused in names as look-alikes of operators; quotes are always right.
  for (char const c : text) plain = plain && words::continues_name(c) && static_cast<unsigned char>(c) < 0x80U;
  return plain;
}

std::string text_of(ast::Column const& column) {
  return (is_plain_identifier(column.name) ? column.name : quoted(column.name)) + bracketed(column.unit);
}

std::string text_of(ast::FunctionDefinition const& function) {
  return fmt::format("function {}({}) = {}", function.name.text, comma_list(function.parameters), unparse(function.value));
}

struct ModelStatementText {
  std::string operator()(ast::TimeDeclaration const& s) const { return "time " + text_of(s.time); }
  std::string operator()(ast::DiscreteTimeDeclaration const& s) const {
    return "time discrete" + (s.step ? " " + unparse(*s.step) : "");
  }
  std::string operator()(ast::InputDeclaration const& s) const { return "input " + comma_list(s.names); }
  std::string operator()(ast::StateDeclaration const& s) const { return "state " + comma_list(s.names); }
  std::string operator()(ast::InitialDeclaration const& s) const { return "initial " + comma_list(s.values); }
  std::string operator()(ast::ParameterDeclaration const& s) const {
    std::string const prior = s.prior ? " ~ " + text_of(*s.prior) : "";
    return fmt::format("parameter {}{}{}", text_of(s.name), prior, s.value ? " = " + unparse(*s.value) : "");
  }
  std::string operator()(ast::Definition const& s) const {
    std::string_view const keyword = s.kind == ast::DefinitionKind::constant ? "constant"
                                     : s.kind == ast::DefinitionKind::local  ? "let"
                                                                             : "derive";
    return fmt::format("{} {} = {}", keyword, text_of(s.name), unparse(s.value));
  }
  std::string operator()(ast::FunctionDefinition const& s) const { return text_of(s); }
  std::string operator()(ast::Observation const& s) const {
    return fmt::format("observe {} ~ {}", text_of(s.channel), text_of(s.noise));
  }
  std::string operator()(ast::Part const& s) const { return fmt::format("part {} = {}", s.name.text, text_of(s.model)); }
  std::string operator()(ast::Equation const& s) const {
    return fmt::format("{} = {}", Printer(true)(s.left, Binding::conditional), unparse(s.right));
  }
};

struct DataStatementText {
  std::string operator()(ast::DataFile const& s) const { return "file " + quoted(s.path.value); }
  std::string operator()(ast::DataTime const& s) const { return "time " + text_of(s.column); }
  std::string operator()(ast::DataRate const& s) const { return (s.step ? "step " : "rate ") + unparse(s.value); }
  std::string operator()(ast::DataInput const& s) const {
    return fmt::format("input {} = {}{}", s.input.text, text_of(s.column), s.rule ? " hold " + s.rule->text : "");
  }
  std::string operator()(ast::DataMeasure const& s) const {
    return fmt::format("measure {} = {}", s.channel.text, text_of(s.column));
  }
  std::string operator()(ast::DataConstant const& s) const {
    return fmt::format("constant {} = {}", s.parameter.text, unparse(s.value));
  }
  std::string operator()(ast::DataSplit const& s) const {
    return "split " + joined(s.parts, ", ", [](ast::SplitPart const& part) {
             return fmt::format("{} = rows {}..{}", part.name.text, unparse(part.first), unparse(part.last));
           });
  }
};

struct CandidateStatementText {
  std::string operator()(ast::Candidate const& s) const {
    std::string const arguments = s.arguments.empty() ? "" : fmt::format("({})", comma_list(s.arguments));
    return s.model.text + arguments + (s.probability ? " probability " + unparse(*s.probability) : "");
  }
  std::string operator()(ast::SharedParameters const& s) const { return "shared " + comma_list(s.names); }
};

struct DictionaryStatementText : ModelStatementText {
  using ModelStatementText::operator();
  std::string operator()(ast::DictionaryStates const& s) const { return "state " + comma_list(s.states); }
  std::string operator()(ast::DictionaryParameter const& s) const {
    return "parameter " + text_of(s.name) + (s.value ? " = " + unparse(*s.value) : "");
  }
  std::string operator()(ast::DictionaryList const& s) const {
    std::string_view const word = s.kind == ast::DictionaryListKind::target  ? "target"
                                  : s.kind == ast::DictionaryListKind::terms ? "terms"
                                                                             : "exclude";
    return fmt::format("{} = {}", word, joined(s.items, ", ", [](auto const& item) { return unparse(item); }));
  }
  std::string operator()(ast::CoefficientUnits const& s) const {
    return "coefficients = " + joined(s.units, ", ", [](auto const& unit) { return fmt::format("[{}]", unparse(unit)); });
  }
};

template <class Statements, class Text>
std::string block(std::string const& head, Statements const& statements, Text text) {
  std::string out = head + " {\n";
  for (auto const& statement : statements) out += "  " + std::visit(text, statement) + "\n";
  return out + "}";
}

struct ItemText {
  std::string operator()(ast::Use const& use) const { return "use " + use.module.text; }
  std::string operator()(ast::Model const& model) const {
    std::string const title = model.title ? " " + quoted(model.title->value) : "";
    std::string const arguments = model.arguments.empty() ? "" : fmt::format("({})", comma_list(model.arguments));
    return block("model " + model.name.text + arguments + title, model.statements, ModelStatementText{});
  }
  std::string operator()(ast::Data const& data) const {
    return block("data " + data.name.text, data.statements, DataStatementText{});
  }
  std::string operator()(ast::Candidates const& set) const {
    std::string const title = set.title ? " " + quoted(set.title->value) : "";
    return block("candidates " + set.name.text + title, set.statements, CandidateStatementText{});
  }
  std::string operator()(ast::Dictionary const& dictionary) const {
    std::string const title = dictionary.title ? " " + quoted(dictionary.title->value) : "";
    return block("dictionary " + dictionary.name.text + title, dictionary.statements, DictionaryStatementText{});
  }
  std::string operator()(ast::FunctionDefinition const& function) const { return text_of(function); }
  std::string operator()(ast::Task const& task) const {
    std::string out = task.name ? task.name->text + " = " : "";
    out += task.verb.text + " " + task.subject.text;
    if (!task.arguments.empty()) out += fmt::format("({})", comma_list(task.arguments));
    if (task.preposition && !task.data.empty()) out += fmt::format(" {} {}", task.preposition->text, comma_list(task.data));
    if (!task.options.empty()) out += " with " + comma_list(task.options);
    return out;
  }
};

}  // namespace

std::string unparse(ast::UnitExpression const& unit) {
  std::string out;
  for (ast::UnitFactor const& factor : unit.factors) {
    bool const first = &factor == &unit.factors.front();
    if (factor.reciprocal)
      out += first ? "1/" : "/";
    else if (!first)
      out += " ";
    out += text_of(factor);
  }
  return out;
}

std::string unparse(ast::Expression const& expression) { return Printer()(expression, Binding::conditional); }

std::string unparse(ast::File const& file) {
  std::string out;
  for (ast::Item const& item : file.items) {
    // Blocks stand apart; neighbouring tasks and functions do not.
    bool const is_block = std::holds_alternative<ast::Model>(item) || std::holds_alternative<ast::Data>(item) ||
                          std::holds_alternative<ast::Candidates>(item) || std::holds_alternative<ast::Dictionary>(item);
    if (!out.empty() && (is_block || out.ends_with("}\n"))) out += "\n";
    out += std::visit(ItemText{}, item) + "\n";
  }
  return out;
}

}  // namespace sysid
