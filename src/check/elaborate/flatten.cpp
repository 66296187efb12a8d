// Writes a model and its parts out: each statement once for each number it stands for, parts in the place of their declaration.
#include "check/elaborate/flatten.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "check/elaborate/frame.hpp"
#include "check/elaborate/part_noise.hpp"
#include "check/elaborate/tree.hpp"
#include "check/message/errors_numbers.hpp"
#include "check/message/errors_reuse.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

// Enough for two thousand terms in each of a hundred equations; some tens of megabytes.
constexpr std::size_t most_nodes = 400'000;
constexpr std::size_t nodes_of_a_model = 100;  // what one costs that says nothing
// Solving for the highest derivatives takes work with the cube of their number.
constexpr std::size_t most_states = 200;
constexpr std::size_t most_states_written_out = 500;

class Flattener {
 public:
  Flattener(Instance const& instance, std::size_t most, Diagnostics& diagnostics)
      : diagnostics_(diagnostics), before_(diagnostics.all().size()), evaluator_(diagnostics, most) {
    root_ = FrameBuilder(diagnostics).build(instance);
  }

  std::size_t left() { return evaluator_.algebra().left(); }

  std::optional<FlatModel> run() {
    ast::Model const& model = root_->model();
    for (ast::ModelStatement const& statement : model.statements) {
      if (auto const* time = std::get_if<ast::TimeDeclaration>(&statement); time != nullptr && evaluator_.time_name.empty())
        evaluator_.time_name = time->time.name.text;
      if (auto const* discrete = std::get_if<ast::DiscreteTimeDeclaration>(&statement)) discrete_ = discrete;
    }
    collect_initial_values(*root_);
    if (failed()) return std::nullopt;
    result_.tree = {{model.span}, {{model.name.span}, root_->instance.display()}, {}, model.title, {}};
    emit(*root_);
    if (failed()) {
      report_unknown_names();
      return std::nullopt;
    }
    drop_noise_of_parts(result_.tree.statements, noise_of_parts());
    collect_shapes(*root_);
    return std::move(result_);
  }

 private:
  bool failed() const { return diagnostics_.all().size() > before_; }

  template <class Statement>
  void add(Statement statement, Span span) {
    std::size_t nodes = 4;
    each_top_expression(statement, [&](ast::Expression const& top) { nodes += tree::size(top, most_nodes); });
    if (evaluator_.algebra().spend(nodes, span)) result_.tree.statements.push_back(std::move(statement));
  }

  // The i-th number of what is declared.
  ast::Declared element(Frame const& frame, ast::Declared const& declared, Shape const& shape, std::size_t i) const {
    ast::Declared flat;
    flat.span = declared.span;
    flat.name = {{declared.name.span}, element_name(frame.prefix + declared.name.text, shape, i)};
    flat.per_experiment = declared.per_experiment;
    flat.unit = with_arguments(declared.unit, frame.instance.arguments);
    return flat;
  }

  // An initial value that the whole states for a part's state takes the place of the part's own.
  void collect_initial_values(Frame& frame) {
    for (ast::ModelStatement const& statement : frame.model().statements) {
      auto const* initial = std::get_if<ast::InitialDeclaration>(&statement);
      if (initial == nullptr) continue;
      for (ast::InitialValue const& each : initial->values) {
        auto const flat = flat_initial(frame, each);
        if (flat)
          for (ast::Expression const& item : flat->items) initial_owner_.emplace(primed(item), &frame);
      }
    }
    for (auto& [name, part] : frame.parts) collect_initial_values(*part);
  }
  static std::string primed(ast::Expression const& state) {
    auto const& reference = std::get<ast::Reference>(state.node);
    return reference.name.text + std::string(static_cast<std::size_t>(reference.primes), '\'');
  }
  std::optional<Array> flat_initial(Frame& frame, ast::InitialValue const& initial) {
    Found const found = find(frame, initial.state.name.text);
    if (found.symbol != nullptr && found.symbol->kind == FrameSymbol::Kind::state)
      return evaluator_.evaluate({{initial.state.span}, initial.state}, frame);
    ast::Reference copy = initial.state;  // no state: the checker says so
    copy.index.clear();
    return scalar({{copy.span}, std::move(copy)});
  }

  void emit(Frame& frame) {
    for (ast::ModelStatement const& statement : frame.model().statements)
      std::visit([&](auto const& one) { take(frame, one); }, statement);
  }

  void take(Frame& frame, ast::TimeDeclaration const& time) {
    std::string const flat = frame.prefix + time.time.name.text;
    if (evaluator_.time_name.empty()) evaluator_.time_name = flat;
    if (frame.outer == nullptr || evaluator_.time_name == flat)
      add(ast::TimeDeclaration{{time.span}, element(frame, time.time, {}, 0)}, time.span);
  }
  void take(Frame& frame, ast::DiscreteTimeDeclaration const& discrete) {
    if (frame.outer == nullptr)
      add(discrete, discrete.span);
    else if (discrete_ == nullptr)
      diagnostics_.add(errors::discrete_part(frame.use, frame.prefix.substr(0, frame.prefix.size() - 1), discrete.span));
  }
  void take(Frame& frame, ast::InputDeclaration const& inputs) {
    ast::InputDeclaration flat{{inputs.span}, {}};
    for (ast::Declared const& input : inputs.names) {
      FrameSymbol& symbol = frame.symbols.at(input.name.text);
      if (symbol.bound())
        bound(frame, input, symbol);
      else
        for (std::size_t i = 0; i < symbol.shape.count(); ++i) flat.names.push_back(element(frame, input, symbol.shape, i));
    }
    if (!flat.names.empty()) add(std::move(flat), inputs.span);
  }
  // What the whole gives to an input or parameter of a part becomes a definition there.
  void bound(Frame& frame, ast::Declared const& declared, FrameSymbol& symbol) {
    auto const value = evaluator_.value_of(frame, declared.name.text, symbol);
    if (!value) return;
    for (std::size_t i = 0; i < value->items.size(); ++i) {
      ast::Declared flat = element(frame, declared, symbol.shape, i);
      flat.per_experiment = false;
      add(ast::Definition{{symbol.value->span}, ast::DefinitionKind::local, std::move(flat), value->items[i]}, symbol.value->span);
    }
  }
  void take(Frame& frame, ast::StateDeclaration const& states) {
    ast::StateDeclaration flat{{states.span}, {}};
    for (ast::Declared const& state : states.names) {
      Shape const shape = frame.symbols.at(state.name.text).shape;
      for (std::size_t i = 0; i < shape.count(); ++i) flat.names.push_back(element(frame, state, shape, i));
    }
    states_ += flat.names.size();
    // A user who writes every name has the patience for it; what vectors and parts make in a few lines is bounded.
    bool const written_out = frame.outer == nullptr && flat.names.size() == states.names.size();
    if (states_ > (written_out ? most_states_written_out : most_states))
      evaluator_.algebra().refuse(states.span);
    else
      add(std::move(flat), states.span);
  }
  void take(Frame& frame, ast::DisturbanceDeclaration const& disturbance) {
    Shape const shape = frame.symbols.at(disturbance.name.name.text).shape;
    auto laws = evaluator_.calls(disturbance.law, shape, frame);
    if (!laws) return;
    for (std::size_t i = 0; i < laws->size(); ++i)
      add(ast::DisturbanceDeclaration{{disturbance.span}, element(frame, disturbance.name, shape, i), std::move((*laws)[i])},
          disturbance.span);
  }
  void take(Frame& frame, ast::InitialDeclaration const& initials) {
    ast::InitialDeclaration flat{{initials.span}, {}};
    for (ast::InitialValue const& initial : initials.values) {
      auto states = flat_initial(frame, initial);
      if (!states) continue;
      std::optional<Array> values;
      std::optional<std::vector<ast::Call>> laws;
      if (initial.value) {
        values = evaluator_.evaluate(*initial.value, frame);
        if (values && states->shape.rank == 0 && values->items.size() > 1) {
          diagnostics_.add(errors::list_of_initial(initial.value->span, initial.state, values->shape));
          continue;
        }
        if (values)
          values = evaluator_.algebra().fill(std::move(*values), states->shape, true,
                                             errors::named("the initial value of", initial.state.name.text), initial.value->span);
        if (!values) continue;
      }
      if (initial.law && !(laws = evaluator_.calls(*initial.law, states->shape, frame))) continue;
      for (std::size_t i = 0; i < states->items.size(); ++i) {
        auto const owner = initial_owner_.find(primed(states->items[i]));
        if (owner != initial_owner_.end() && owner->second != &frame) continue;
        ast::InitialValue one{{initial.span}, std::get<ast::Reference>(std::move(states->items[i].node)), {}, {}};
        if (values) one.value = std::move(values->items[i]);
        if (laws) one.law = std::move((*laws)[i]);
        flat.values.push_back(std::move(one));
      }
    }
    if (!flat.values.empty()) add(std::move(flat), initials.span);
  }
  void take(Frame& frame, ast::ParameterDeclaration const& parameter) {
    FrameSymbol& symbol = frame.symbols.at(parameter.name.name.text);
    if (symbol.bound()) return bound(frame, parameter.name, symbol);
    std::optional<std::vector<ast::Call>> priors;
    std::optional<Array> values;
    if (parameter.prior && !(priors = evaluator_.calls(*parameter.prior, symbol.shape, frame))) return;
    if (parameter.value) {
      values = evaluator_.evaluate(*parameter.value, frame);
      if (values)
        values = evaluator_.algebra().fill(std::move(*values), symbol.shape, true,
                                           errors::named("the value of", parameter.name.name.text), parameter.value->span);
      if (!values) return;
    }
    for (std::size_t i = 0; i < symbol.shape.count(); ++i) {
      ast::ParameterDeclaration flat{{parameter.span}, element(frame, parameter.name, symbol.shape, i), {}, {}};
      if (priors) flat.prior = std::move((*priors)[i]);
      if (values) flat.value = std::move(values->items[i]);
      add(std::move(flat), parameter.span);
    }
  }
  void take(Frame& frame, ast::Definition const& definition) {
    FrameSymbol& symbol = frame.symbols.at(definition.name.name.text);
    // A second definition of a name: the checker says so.
    bool const second = symbol.value != &definition.value;
    auto const value =
        second ? evaluator_.evaluate(definition.value, frame) : evaluator_.value_of(frame, definition.name.name.text, symbol);
    if (!value) return;
    // What is reported says its size: a comma too many would else make two quantities of one.
    if (definition.kind == ast::DefinitionKind::derived && definition.name.sizes.empty() && value->shape.rank > 0) {
      diagnostics_.add(errors::wrong_shape(definition.value.span, errors::named("the value of", definition.name.name.text),
                                           value->shape, Shape{}));
      return;
    }
    for (std::size_t i = 0; i < value->items.size(); ++i)
      add(ast::Definition{{definition.span}, definition.kind, element(frame, definition.name, value->shape, i), value->items[i]},
          definition.span);
  }
  void take(Frame& frame, ast::FunctionDefinition const& function) {
    if (frame.outer == nullptr) add(function, function.span);
  }
  void take(Frame& frame, ast::ProcessDefinition const& process) {
    if (frame.outer != nullptr) {
      diagnostics_.add(errors::process_of_part(frame.use, frame.prefix.substr(0, frame.prefix.size() - 1), process.span));
      return;
    }
    if (auto call = evaluator_.call_arguments(process.process, frame))
      add(ast::ProcessDefinition{{process.span}, process.name, process.inputs, std::move(*call)}, process.span);
  }
  void take(Frame& frame, ast::Observation const& observation) {
    if (frame.outer != nullptr) {
      ignored_.push_back({&frame, &observation});
      return;
    }
    auto const shape = channel_shape(frame, observation.channel);
    if (!shape) return;
    auto noises = evaluator_.calls(observation.noise, *shape, frame);
    if (!noises) return;
    if (shape->rank == 0 && !noises->front().arguments.empty())
      if (auto const* list = std::get_if<ast::Box<ast::List>>(&noises->front().arguments.front().value.node)) {
        diagnostics_.add(
            errors::wrong_shape(observation.noise.arguments.front().value.span,
                                errors::Subject{fmt::format("what channel `{}` measures", observation.channel.name.text),
                                                {observation.channel.name.text}},
                                vector_of(static_cast<int>((*list)->items.size())), Shape{}));
        return;
      }
    for (std::size_t i = 0; i < noises->size(); ++i)
      add(ast::Observation{{observation.span}, element(frame, observation.channel, *shape, i), std::move((*noises)[i])},
          observation.span);
    if (shape->rank > 0) result_.shapes[observation.channel.name.text] = *shape;
  }
  void take(Frame& frame, ast::Part const& part) { emit(*frame.parts.at(part.name.text)); }
  void take(Frame& frame, ast::Equation const& equation) {
    auto left = evaluator_.evaluate(equation.left, frame), right = evaluator_.evaluate(equation.right, frame);
    if (!left || !right) return;
    bool const more_left = left->shape.count() > right->shape.count() ||
                           (left->shape.count() == right->shape.count() && left->shape.rank >= right->shape.rank);
    Shape const shape = more_left ? left->shape : right->shape;
    Array& lesser = more_left ? *right : *left;
    bool const fits =
        lesser.shape == shape || (lesser.shape.count() == 1 && (shape.count() == 1 || tree::is_plain_number(lesser.items.front())));
    if (!fits) {
      diagnostics_.add(
          errors::shape_conflict(equation.span, "=", left->shape, equation.left.span, right->shape, equation.right.span));
      return;
    }
    auto filled = evaluator_.algebra().fill(std::move(lesser), shape, true, {}, equation.span);
    if (!filled) return;
    lesser = std::move(*filled);
    for (std::size_t i = 0; i < shape.count(); ++i)
      add(ast::Equation{{equation.span}, std::move(left->items[i]), std::move(right->items[i])}, equation.span);
  }

  // A name that nothing declares passes for a number here, so that shapes may disagree on its account: then it is the name that is
  // reported. Where the model goes on to the next stage this is done there.
  void report_unknown_names() {
    std::vector<Diagnostic> unknown;
    std::set<std::string> channels{"pi", "inf"};
    errors::Names known;
    for (auto const& [name, symbol] : root_->symbols) known.push_back(name);
    for (ast::ModelStatement const& statement : root_->model().statements)
      if (auto const* observation = std::get_if<ast::Observation>(&statement)) channels.insert(observation->channel.name.text);
    for (ast::ModelStatement const& statement : root_->model().statements) {
      if (!std::holds_alternative<ast::Equation>(statement) && !std::holds_alternative<ast::Definition>(statement)) continue;
      each_reference(statement, [&](ast::Reference const& reference) {
        std::string const& name = reference.name.text;
        bool const elsewhere = name.find('.') != std::string::npos || channels.contains(name) ||
                               root_->instance.arguments.contains(name) || find(*root_, name).symbol != nullptr;
        if (!elsewhere) unknown.push_back(errors::unknown_name(reference.name, known));
      });
    }
    if (unknown.empty()) return;
    std::vector<Diagnostic> all = diagnostics_.all();
    all.erase(std::remove_if(all.begin() + static_cast<std::ptrdiff_t>(before_), all.end(),
                             [](Diagnostic const& each) { return each.code == "E2704"; }),
              all.end());
    all.insert(all.end(), unknown.begin(), unknown.end());
    diagnostics_.replace(std::move(all));
  }

  std::optional<Shape> channel_shape(Frame const& frame, ast::Declared const& channel) {
    if (channel.sizes.empty()) return Shape{};
    auto const size = channel.sizes.size() == 1 ? whole_number(channel.sizes.front(), frame.instance.arguments) : std::nullopt;
    if (channel.sizes.size() > 1) {
      diagnostics_.add(errors::too_many_sizes(channel.span, channel.name.text));
    } else if (!size) {
      diagnostics_.add(errors::size_needed(channel, 0));
    } else if (*size < 1 || *size > 1000) {
      diagnostics_.add(errors::size_out_of_range(channel.sizes.front().span, channel.name.text, *size, 1000));
    } else {
      return vector_of(static_cast<int>(*size));
    }
    return std::nullopt;
  }

  // What `observe` of parts reads of them, vectors as wholes: none of it is written out.
  std::set<std::string> noise_of_parts() {
    std::set<std::string> noise;
    for (auto const& [frame, observation] : ignored_)
      for (ast::Argument const& argument : observation->noise.arguments)
        each_expression(argument.value, [&, frame = frame](ast::Expression const& each) {
          auto const* reference = std::get_if<ast::Reference>(&each.node);
          Found const found = reference == nullptr ? Found{} : find(*frame, reference->name.text);
          if (found.symbol != nullptr) noise.insert(found.frame->prefix + found.name);
        });
    return noise;
  }

  void collect_shapes(Frame const& frame) {
    for (auto const& [name, symbol] : frame.symbols)
      if (symbol.shape.rank > 0) result_.shapes[frame.prefix + name] = symbol.shape;
    for (auto const& [name, part] : frame.parts) collect_shapes(*part);
  }

  Diagnostics& diagnostics_;
  std::size_t before_;
  Evaluator evaluator_;
  std::unique_ptr<Frame> root_;
  ast::DiscreteTimeDeclaration const* discrete_ = nullptr;
  std::map<std::string, Frame const*> initial_owner_;
  std::vector<std::pair<Frame*, ast::Observation const*>> ignored_;
  std::size_t states_ = 0;
  FlatModel result_;
};

void collect_parts(Frame const& frame, std::vector<Instance>& instances) {
  for (auto const& [name, part] : frame.parts) {
    collect_parts(*part, instances);
    instances.push_back(part->instance);
  }
}

}  // namespace

std::vector<Instance> parts_of(Instance const& instance) {
  Diagnostics said_by_flatten;
  std::vector<Instance> instances;
  collect_parts(*FrameBuilder(said_by_flatten).build(instance), instances);
  return instances;
}

std::optional<FlatModel> flatten(Instance const& instance, std::size_t& left, Diagnostics& diagnostics) {
  std::size_t const most = std::min(most_nodes, left);
  Flattener flattener(instance, most, diagnostics);
  auto model = flattener.run();
  left -= std::min(left, most - flattener.left() + nodes_of_a_model);
  return model;
}

}  // namespace sysid
