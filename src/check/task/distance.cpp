// An expression is built once, in a graph of its own and in the units of the first candidate, and then copied into each model.
#include "check/task/distance.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>

#include "check/expression/non_negative.hpp"
#include "check/message/errors.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

bool reads_channel(std::string const& function) {
  return function == "measured" || function == "predicted" || function == "residual";
}

class DistanceChecker {
 public:
  DistanceChecker(DistanceOptions const& options, std::vector<std::string> channels, CandidateSet const& set, CheckedFile& file,
                  OptionReader& reader, Diagnostics& diagnostics)
      : options_(options),
        set_(set),
        file_(file),
        reader_(reader),
        diagnostics_(diagnostics),
        before_(diagnostics.all().size()),
        first_(file.models[static_cast<std::size_t>(set.models.front().model)]) {
    rule_.channels = std::move(channels);
    rule_.stated = options.distance != nullptr || options.weights != nullptr;
    rule_.weights.assign(rule_.channels.size(), 1.0);
    rule_.text = options.distance == nullptr ? "nmse" : unparse(options.distance->value);
  }

  DistanceRule run() {
    if (options_.weights != nullptr) weights();
    if (options_.distance != nullptr && !diagnostics_.has_errors(before_)) distance();
    return std::move(rule_);
  }

 private:
  Channel const& channel(std::size_t k) const {
    return *std::find_if(first_.channels.begin(), first_.channels.end(),
                         [&](Channel const& each) { return each.name == rule_.channels[k]; });
  }
  std::size_t index_of(std::string const& name) const {
    return static_cast<std::size_t>(std::find(rule_.channels.begin(), rule_.channels.end(), name) - rule_.channels.begin());
  }

  void weights() {
    ast::Call const* call = as_call(options_.weights->value);
    if (call == nullptr || call->arguments.empty()) {
      diagnostics_.add(errors::option_kind(options_.weights->span, "weights", {"a weight for each channel"},
                                           "weights(" + rule_.channels.front() + " = 1)"));
      return;
    }
    std::map<std::string, Span> given;
    for (ast::Argument const& argument : call->arguments) {
      if (!argument.name) {
        diagnostics_.add(errors::must_be_named(*call, argument, rule_.channels));
        continue;
      }
      std::size_t const k = index_of(argument.name->text);
      if (k == rule_.channels.size()) {
        diagnostics_.add(errors::unknown_member(*argument.name, {"this selection"}, "measured channel", rule_.channels));
        continue;
      }
      if (auto const [place, fresh] = given.emplace(argument.name->text, argument.span); !fresh) {
        diagnostics_.add(errors::stated_twice(argument.span, place->second, errors::named(argument.name->text)));
        continue;
      }
      if (auto const value = reader_.pure_number(argument.value, argument.name->text, Unit{}, 0, 1e300)) {
        rule_.weights[k] = *value;
        if (*value > 0) rule_.weighted.push_back(rule_.channels[k]);
      }
    }
    if (std::all_of(rule_.weights.begin(), rule_.weights.end(), [](double weight) { return weight == 0; }))
      diagnostics_.add(errors::no_weight(options_.weights->span));
  }

  void distance() {
    ast::Expression const& tree = options_.distance->value;
    auto const* name = std::get_if<ast::Reference>(&tree.node);
    if (name != nullptr && name->index.empty() && name->primes == 0) {
      if (name->name.text == "rmse")
        root_mean_square();
      else if (name->name.text != "nmse")
        diagnostics_.add(errors::distance_choice(tree.span, name->name.text, rule_.channels.front()));
      return;
    }
    rule_.kind = DistanceRule::Kind::expression;
    auto const* list = std::get_if<ast::Box<ast::List>>(&tree.node);
    for (ast::Expression const& each : list == nullptr ? std::span(&tree, 1) : std::span<ast::Expression const>((*list)->items))
      expression(each);
    if (diagnostics_.has_errors(before_)) return;
    for (std::size_t k = 0; k < rule_.channels.size(); ++k)
      if (!found_.contains(k) && rule_.weights[k] > 0) {
        diagnostics_.add(errors::distance_lacks_channel(tree.span, rule_.channels[k]));
        return;
      }
    one_unit();
    if (diagnostics_.has_errors(before_)) return;
    for (CandidateModel const& candidate : set_.models)
      rule_.expressions.push_back(copied(file_.models[static_cast<std::size_t>(candidate.model)]));
  }

  // Their mean must have a unit.
  void root_mean_square() {
    rule_.kind = DistanceRule::Kind::rmse;
    Channel const* first = nullptr;
    for (std::size_t k = 0; k < rule_.channels.size(); ++k) {
      if (rule_.weights[k] == 0 || !channel(k).unit) continue;
      if (first == nullptr) {
        first = &channel(k);
        rule_.unit = first->unit->scale;
      }
      if (channel(k).unit->dimension != first->unit->dimension) {
        diagnostics_.add(
            errors::distances_of_two_kinds(options_.distance->span, first->name, *first->unit, channel(k).name, *channel(k).unit));
        return;
      }
    }
  }

  void one_unit() {
    Item const* first = nullptr;
    for (auto const& [k, item] : found_) {
      if (item.value.kind == Typed::Kind::unknown) continue;
      Unit const unit = item.value.kind == Typed::Kind::known ? item.value.unit : Unit{};
      if (first != nullptr && unit.dimension != (first->value.kind == Typed::Kind::known ? first->value.unit : Unit{}).dimension) {
        diagnostics_.add(errors::expressions_of_two_units(item.tree->span, unit, first->tree->span,
                                                          first->value.kind == Typed::Kind::known ? first->value.unit : Unit{}));
        return;
      }
      if (first == nullptr) first = &item;
    }
  }

  // States and parameters are of one model, and other samples of no candidate's present.
  bool reads_only_channels(ast::Expression const& tree) {
    bool good = true;
    std::vector<Span> channels;  // names inside of measured(...) and its kin
    each_expression(tree, [&](ast::Expression const& each) {
      if (auto const* call = std::get_if<ast::Box<ast::Call>>(&each.node)) {
        std::string const& function = (*call)->function.text;
        if (reads_channel(function))
          for (ast::Argument const& argument : (*call)->arguments) channels.push_back(argument.value.span);
        if (good && (function == "lag" || function == "lags" || function == "since_last")) {
          diagnostics_.add(errors::distance_reads(each.span, function));
          good = false;
        }
      }
      auto const* name = std::get_if<ast::Reference>(&each.node);
      if (name == nullptr || !good || name->name.text == "pi") return;
      if (std::any_of(channels.begin(), channels.end(),
                      [&](Span span) { return span.begin <= each.span.begin && each.span.end <= span.end; }))
        return;
      diagnostics_.add(errors::distance_reads(each.span, name->name.text));
      good = false;
    });
    return good;
  }

  // `displacement[2]` is the name of a channel.
  static ast::Expression with_elements(ast::Expression tree) {
    if (auto* call = std::get_if<ast::Box<ast::Call>>(&tree.node)) {
      for (ast::Argument& argument : (*call)->arguments) {
        auto* name = reads_channel((*call)->function.text) ? std::get_if<ast::Reference>(&argument.value.node) : nullptr;
        if (name == nullptr || name->index.empty()) {
          argument.value = with_elements(std::move(argument.value));
          continue;
        }
        name->name.text = unparse(argument.value);
        name->index.clear();
      }
    } else if (auto* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node)) {
      (*binary)->left = with_elements(std::move(*(*binary)->left));
      (*binary)->right = with_elements(std::move(*(*binary)->right));
    } else if (auto* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node)) {
      (*unary)->operand = with_elements(std::move(*(*unary)->operand));
    } else if (auto* choice = std::get_if<ast::Box<ast::Conditional>>(&tree.node)) {
      (*choice)->condition = with_elements(std::move(*(*choice)->condition));
      (*choice)->then = with_elements(std::move(*(*choice)->then));
      (*choice)->otherwise = with_elements(std::move(*(*choice)->otherwise));
    }
    return tree;
  }

  void expression(ast::Expression const& tree) {
    if (!reads_only_channels(tree)) return;
    std::vector<ast::FunctionDefinition const*> functions;
    for (ast::Item const& item : file_.tree.items)
      if (auto const* function = std::get_if<ast::FunctionDefinition>(&item)) functions.push_back(function);
    Scope scope(graph_, diagnostics_, std::move(functions));
    for (std::size_t k = 0; k < rule_.channels.size(); ++k)
      scope.samples().channels.emplace(rule_.channels[k], SampleNames::Channel{static_cast<int>(k), channel(k).unit});
    std::size_t const before = diagnostics_.all().size();
    auto const value = scope.expression(with_elements(tree));
    if (!value || diagnostics_.has_errors(before)) return;
    std::set<std::size_t> read;
    for (NodeId const id : graph_.reachable({&value->node, 1}))
      if (graph_[id].operation == Operation::leaf) read.insert(static_cast<std::size_t>(graph_[id].index));
    if (read.size() != 1) {
      std::vector<std::string> names;
      for (std::size_t const k : read) names.push_back(rule_.channels[k]);
      diagnostics_.add(errors::distance_of_one_channel(tree.span, names, rule_.channels.front()));
      return;
    }
    if (!non_negative(graph_, value->node)) {
      diagnostics_.add(errors::distance_may_be_negative(tree.span, unparse(tree)));
      return;
    }
    auto const [place, fresh] = found_.emplace(*read.begin(), Item{&tree, with_own_unit(*value)});
    if (!fresh)
      diagnostics_.add(errors::stated_twice(tree.span, place->second.tree->span,
                                            errors::named("the distance of", rule_.channels[place->first])));
  }

  // The expressions in the leaves of a model; 0 for a channel of no weight.
  std::vector<NodeId> copied(Model& model) const {
    std::vector<NodeId> nodes;
    for (std::size_t k = 0; k < rule_.channels.size(); ++k) {
      auto const item = found_.find(k);
      nodes.push_back(item == found_.end() ? model.graph.constant(0) : copied(model, item->second.value.node, rule_.channels[k]));
    }
    return nodes;
  }

  NodeId copied(Model& model, NodeId root, std::string const& name) const {
    auto const channel =
        std::find_if(model.channels.begin(), model.channels.end(), [&](Channel const& each) { return each.name == name; });
    std::map<NodeId, NodeId> made;
    for (NodeId const id : graph_.reachable({&root, 1})) {
      Node const& node = graph_[id];
      if (node.operation == Operation::constant)
        made[id] = model.graph.constant(node.value);
      else if (node.operation != Operation::leaf)
        made[id] = model.graph.rebuild(node, made[node.a], made[node.b], made[node.c]);
      else if (node.leaf_kind == LeafKind::measured)
        made[id] = from_zero_of_first(model, *channel,
                                      model.graph.leaf(LeafKind::measured, static_cast<int>(channel - model.channels.begin())));
      else  // what stands for predicted(channel)
        made[id] = from_zero_of_first(model, *channel, channel->noise.row->centre(model.graph, channel->noise.arguments));
    }
    return made[root];
  }

  // A temperature counts from the zero point of its model's unit, and the expression has that of the first candidate.
  NodeId from_zero_of_first(Model& model, Channel const& own, NodeId node) const {
    Channel const& first = channel(index_of(own.name));
    double const shift = own.unit && first.unit ? own.unit->offset - first.unit->offset : 0;
    return shift == 0 ? node : model.graph.add(node, model.graph.constant(shift));
  }

  struct Item {
    ast::Expression const* tree;
    Typed value;
  };

  DistanceOptions const& options_;
  CandidateSet const& set_;
  CheckedFile& file_;
  OptionReader& reader_;
  Diagnostics& diagnostics_;
  std::size_t before_;
  Model const& first_;
  DistanceRule rule_;
  Graph graph_;
  std::map<std::size_t, Item> found_;  // by channel
};

}  // namespace

DistanceRule check_distance(DistanceOptions const& options, std::vector<std::string> channels, CandidateSet const& set,
                            CheckedFile& file, OptionReader& reader, Diagnostics& diagnostics) {
  return DistanceChecker(options, std::move(channels), set, file, reader, diagnostics).run();
}

}  // namespace sysid
