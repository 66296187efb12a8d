// Declares the names of a model and of its parts, and binds what the whole gives to each part.
#include "check/elaborate/frame.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "check/elaborate/tree.hpp"
#include "check/message/errors_numbers.hpp"
#include "check/message/errors_reuse.hpp"

namespace sysid {
namespace {

constexpr long most_elements = 10000;
constexpr std::size_t most_frames = 1000;
constexpr std::size_t deepest_call = 50;

}  // namespace

std::string Instance::display() const {
  std::string text;
  for (ast::ModelArgument const& argument : model.tree->arguments)
    if (auto const value = arguments.find(argument.name.text); value != arguments.end())
      text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", argument.name.text, value->second);
  return text.empty() ? model.tree->name.text : fmt::format("{}({})", model.tree->name.text, text);
}

std::optional<WholeNumbers> model_arguments(ast::Model const& model, std::vector<ast::Argument> const& given, Span use,
                                            WholeNumbers const& known, Diagnostics& diagnostics) {
  WholeNumbers result;
  bool good = true;
  for (ast::ModelArgument const& argument : model.arguments) {
    auto const place = std::find_if(given.begin(), given.end(),
                                    [&](ast::Argument const& each) { return each.name && each.name->text == argument.name.text; });
    std::optional<long> value;
    if (place != given.end()) {
      value = whole_number(place->value, known);
      if (!value) diagnostics.add(errors::whole_number_needed(place->value.span, errors::named(argument.name.text)));
    } else if (argument.value) {
      value = whole_number(*argument.value, result);
      if (!value) diagnostics.add(errors::whole_number_needed(argument.value->span, errors::named(argument.name.text)));
    } else {
      diagnostics.add(errors::model_argument_missing(use, model.name.text, argument.name.text));
    }
    good = good && value;
    if (value) result[argument.name.text] = *value;
  }
  return good ? std::optional(result) : std::nullopt;
}

Found find(Frame& frame, std::string const& path) {
  Frame* at = &frame;
  std::size_t begin = 0;
  for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', begin)) {
    auto const part = at->parts.find(path.substr(begin, dot - begin));
    if (part == at->parts.end()) return {};
    at = part->second.get();
    begin = dot + 1;
  }
  std::string name = path.substr(begin);
  auto const symbol = at->symbols.find(name);
  if (symbol == at->symbols.end()) return {};
  return {at, &symbol->second, std::move(name)};
}

std::unique_ptr<Frame> FrameBuilder::build(Instance const& instance) {
  auto frame = std::make_unique<Frame>();
  frame->instance = instance;
  declare(*frame);
  return frame;
}

std::optional<Shape> FrameBuilder::shape_of(Frame const& frame, ast::Declared const& declared) {
  if (declared.sizes.empty()) return Shape{};
  if (declared.sizes.size() > 2) {
    diagnostics_.add(errors::too_many_sizes(cover(declared.sizes.front().span, declared.sizes.back().span), declared.name.text));
    return std::nullopt;
  }
  long sizes[2] = {1, 1};
  for (std::size_t i = 0; i < declared.sizes.size(); ++i) {
    auto const size = whole_number(declared.sizes[i], frame.instance.arguments);
    if (!size) {
      diagnostics_.add(errors::size_needed(declared, i));
      return std::nullopt;
    }
    if (*size < 1 || *size > most_elements || sizes[0] * *size > most_elements) {
      diagnostics_.add(errors::size_out_of_range(declared.sizes[i].span, declared.name.text, *size, most_elements / sizes[0]));
      return std::nullopt;
    }
    sizes[i] = *size;
  }
  return declared.sizes.size() == 1 ? vector_of(static_cast<int>(sizes[0]))
                                    : matrix_of(static_cast<int>(sizes[0]), static_cast<int>(sizes[1]));
}

void FrameBuilder::declare(Frame& frame, ast::Declared const& declared, FrameSymbol symbol) {
  symbol.declared = &declared;
  if (auto const shape = shape_of(frame, declared)) {
    symbol.shape = *shape;
    frame.symbols.emplace(declared.name.text, std::move(symbol));  // a second one is the checker's to report
  }
}

void FrameBuilder::declare(Frame& frame) {
  using Kind = FrameSymbol::Kind;
  auto const symbol = [](Kind kind) {
    FrameSymbol made;
    made.kind = kind;
    return made;
  };
  for (ast::ModelStatement const& statement : frame.model().statements) {
    if (auto const* time = std::get_if<ast::TimeDeclaration>(&statement)) {
      declare(frame, time->time, symbol(Kind::time));
    } else if (auto const* inputs = std::get_if<ast::InputDeclaration>(&statement)) {
      for (ast::Declared const& input : inputs->names) declare(frame, input, symbol(Kind::input));
    } else if (auto const* states = std::get_if<ast::StateDeclaration>(&statement)) {
      for (ast::Declared const& state : states->names) declare(frame, state, symbol(Kind::state));
    } else if (auto const* disturbance = std::get_if<ast::DisturbanceDeclaration>(&statement)) {
      declare(frame, disturbance->name, symbol(Kind::disturbance));
    } else if (auto const* parameter = std::get_if<ast::ParameterDeclaration>(&statement)) {
      declare(frame, parameter->name, symbol(Kind::parameter));
    } else if (auto const* definition = std::get_if<ast::Definition>(&statement)) {
      FrameSymbol made = symbol(Kind::definition);
      made.value = &definition->value;
      made.value_frame = &frame;
      made.shape_known = !definition->name.sizes.empty();
      declare(frame, definition->name, std::move(made));
    } else if (auto const* function = std::get_if<ast::FunctionDefinition>(&statement)) {
      frame.functions.emplace(function->name.text, function);
    }
  }
  for (ast::ModelArgument const& argument : frame.model().arguments)
    if (auto const taken = frame.symbols.find(argument.name.text); taken != frame.symbols.end())
      diagnostics_.add(errors::duplicate_name(taken->second.declared->name, argument.name.span));
  for (ast::ModelStatement const& statement : frame.model().statements)
    if (auto const* part = std::get_if<ast::Part>(&statement)) add_part(frame, *part);
}

void FrameBuilder::add_part(Frame& frame, ast::Part const& part) {
  Environment const& home = *frame.instance.model.home;
  if (auto const taken = frame.symbols.find(part.name.text); taken != frame.symbols.end()) {
    diagnostics_.add(errors::duplicate_name(part.name, taken->second.declared->name.span));
    return;
  }
  if (auto const taken = frame.parts.find(part.name.text); taken != frame.parts.end()) {
    diagnostics_.add(errors::duplicate_name(part.name, taken->second->use));
    return;
  }
  auto const model = home.models.find(part.model.function.text);
  if (model == home.models.end()) {
    errors::Names known;
    for (auto const& [name, entry] : home.models) known.push_back(name);
    diagnostics_.add(errors::unknown_item(part.model.function, "model", known));
    return;
  }
  errors::Names loop = {model->second.tree->name.text};
  std::size_t depth = 1;
  for (Frame const* outer = &frame; outer != nullptr; outer = outer->outer) {
    ++depth;
    loop.push_back(outer->model().name.text);
    if (&outer->model() != model->second.tree) continue;
    std::reverse(loop.begin(), loop.end());
    diagnostics_.add(errors::part_cycle(part.model.function.span, loop));
    return;
  }
  if (too_large_) return;
  if (++frames_ > most_frames || depth > deepest_call) {
    too_large_ = true;
    diagnostics_.add(errors::model_too_large(part.name.span));
    return;
  }
  auto arguments =
      model_arguments(*model->second.tree, part.model.arguments, part.model.function.span, frame.instance.arguments, diagnostics_);
  if (!arguments) return;
  auto inner = std::make_unique<Frame>();
  inner->outer = &frame;
  inner->instance = {model->second, std::move(*arguments)};
  inner->prefix = frame.prefix + part.name.text + ".";
  inner->use = part.name.span;
  Frame& made = *inner;
  frame.parts.emplace(part.name.text, std::move(inner));
  declare(made);
  bind(made, part);
}

void FrameBuilder::bind(Frame& inner, ast::Part const& part) {
  std::string const& model = part.model.function.text;
  errors::Names known;
  for (ast::ModelArgument const& argument : inner.model().arguments) known.push_back(argument.name.text);
  for (auto const& [name, symbol] : inner.symbols)
    if (symbol.kind == FrameSymbol::Kind::input || symbol.kind == FrameSymbol::Kind::parameter) known.push_back(name);
  std::map<std::string, Span> given;
  bool misnamed = false;  // what stands under a wrong name may be meant for an input
  for (std::size_t i = 0; i < part.model.arguments.size(); ++i) {
    ast::Argument const& argument = part.model.arguments[i];
    if (!argument.name) {
      diagnostics_.add(errors::model_argument_by_position(part.model.arguments, i, model, known));
      misnamed = true;
      continue;
    }
    std::string const& name = argument.name->text;
    if (auto const [first, fresh] = given.emplace(name, argument.name->span); !fresh) {
      diagnostics_.add(errors::model_argument_twice(argument.name->span, first->second, name));
      continue;
    }
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      diagnostics_.add(errors::unknown_model_argument(*argument.name, model, known));
      misnamed = true;
      continue;
    }
    auto const symbol = inner.symbols.find(name);
    if (symbol == inner.symbols.end()) continue;  // a whole number
    symbol->second.value = &argument.value;
    symbol->second.value_frame = inner.outer;
  }
  errors::Names open;
  for (ast::ModelStatement const& statement : inner.model().statements)
    if (auto const* inputs = std::get_if<ast::InputDeclaration>(&statement))
      for (ast::Declared const& input : inputs->names)
        if (!given.contains(input.name.text)) open.push_back(input.name.text);
  if (!open.empty() && !misnamed) diagnostics_.add(errors::input_of_part_unbound(part.name.span, part.name.text, open, model));
}

}  // namespace sysid
