// Canonical text: one statement a line, two blanks of indentation in blocks.
#include "syntax/unparse.hpp"

#include <fmt/format.h>

#include "syntax/expression_text.hpp"
#include "syntax/words.hpp"

namespace sysid {
namespace {

using sysid::text_of;  // beside those below

std::string text_of(ast::InitialValue const& value) {
  return text_of(value.state) + (value.law ? " ~ " + text_of(*value.law) : value.value ? " = " + unparse(*value.value) : "");
}

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
  return (is_plain_identifier(column.name) ? column.name : string_literal(column.name)) + bracketed(column.unit);
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
  std::string operator()(ast::DisturbanceDeclaration const& s) const {
    return fmt::format("disturbance {} ~ {}", text_of(s.name), text_of(s.law));
  }
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
  std::string operator()(ast::ProcessDefinition const& s) const {
    return fmt::format("function {}({}) ~ {}", s.name.text, comma_list(s.inputs), text_of(s.process));
  }
  std::string operator()(ast::Observation const& s) const {
    return fmt::format("observe {} ~ {}", text_of(s.channel), text_of(s.noise));
  }
  std::string operator()(ast::Part const& s) const { return fmt::format("part {} = {}", s.name.text, text_of(s.model)); }
  std::string operator()(ast::Equation const& s) const { return fmt::format("{} = {}", leading_text(s.left), unparse(s.right)); }
};

struct DataStatementText {
  std::string operator()(ast::DataFile const& s) const { return "file " + string_literal(s.path.value); }
  std::string operator()(ast::DataTime const& s) const { return "time " + text_of(s.column); }
  std::string operator()(ast::DataRate const& s) const { return (s.step ? "step " : "rate ") + unparse(s.value); }
  std::string operator()(ast::DataInput const& s) const {
    return fmt::format("input {} = {}{}{}", s.input.text, text_of(s.column), s.rule ? " hold " + s.rule->text : "",
                       s.error ? " error " + text_of(*s.error) : "");
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
  std::string operator()(ast::DataReading const& s) const {
    return "read " + joined(s.settings, ", ", [](ast::ReadingSetting const& setting) {
             std::string const items = joined(setting.items, setting.range ? ".." : ", ", [](ast::ReadingItem const& item) {
               return item.quoted ? string_literal(item.value) : item.value;
             });
             bool const list = setting.items.size() > 1 && !setting.range;
             return fmt::format("{} = {}", setting.name.text, list ? "(" + items + ")" : items);
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
    return "parameter " + text_of(s.name) + (s.prior ? " ~ " + text_of(*s.prior) : s.value ? " = " + unparse(*s.value) : "");
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
    std::string const title = model.title ? " " + string_literal(model.title->value) : "";
    std::string const arguments = model.arguments.empty() ? "" : fmt::format("({})", comma_list(model.arguments));
    return block("model " + model.name.text + arguments + title, model.statements, ModelStatementText{});
  }
  std::string operator()(ast::Data const& data) const {
    return block("data " + data.name.text, data.statements, DataStatementText{});
  }
  std::string operator()(ast::Candidates const& set) const {
    std::string const title = set.title ? " " + string_literal(set.title->value) : "";
    return block("candidates " + set.name.text + title, set.statements, CandidateStatementText{});
  }
  std::string operator()(ast::Dictionary const& dictionary) const {
    std::string const title = dictionary.title ? " " + string_literal(dictionary.title->value) : "";
    return block("dictionary " + dictionary.name.text + title, dictionary.statements, DictionaryStatementText{});
  }
  std::string operator()(ast::FunctionDefinition const& function) const { return text_of(function); }
  std::string operator()(ast::Task const& task) const {
    std::string out = task.name ? task.name->text + " = " : "";
    out += task.verb.text + " " + task.subject.text;
    if (!task.arguments.empty()) out += fmt::format("({})", comma_list(task.arguments));
    for (ast::Name const& other : task.others) out += ", " + other.text;
    if (task.preposition && !task.data.empty()) out += fmt::format(" {} {}", task.preposition->text, comma_list(task.data));
    if (!task.options.empty()) out += " with " + comma_list(task.options);
    return out;
  }
};

}  // namespace

std::string unparse(ast::ModelStatement const& statement) { return std::visit(ModelStatementText{}, statement); }

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
