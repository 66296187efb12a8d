// A data block and a model: names, units, rules between samples and constants must agree.
#include "check/data/binding.hpp"

#include <algorithm>
#include <cmath>

#include "check/message/errors.hpp"
#include "check/units/units.hpp"
#include "data/input_rule.hpp"
#include "data/table/column_unit_errors.hpp"

namespace sysid {
namespace {

std::vector<std::string> rules_with_rate() {
  std::vector<std::string> names;
  for (InputRuleRow const& row : input_rules())
    if (row.has_rate) names.emplace_back(row.name);
  return names;
}

/// What only observations read, such as the sd of each sample, is read at rows alone.
bool read_between_rows(Model const& model, std::size_t input) {
  auto const reads = [&](NodeId root) {
    return model.graph.depends(root, [&](Node const& leaf) {
      return (leaf.leaf_kind == LeafKind::input || leaf.leaf_kind == LeafKind::input_rate) && leaf.index == static_cast<int>(input);
    });
  };
  if (model.implicit) return true;
  return std::any_of(model.states.begin(), model.states.end(), [&](State const& state) { return reads(state.derivative); });
}

}  // namespace

void check_between_samples(DataBlock const& block, Model const* model, Diagnostics& diagnostics) {
  if (model != nullptr && model->dynamics == Dynamics::none) return;
  bool const has_step = model != nullptr && model->step;
  if (!block.time && !(block.step > 0) && !has_step) diagnostics.add(errors::no_time({{block.span}, block.name}));
  if (model != nullptr && model->dynamics == Dynamics::discrete) return;
  for (DataInputUse const& use : block.inputs) {
    bool wanted = model == nullptr;
    for (std::size_t i = 0; model != nullptr && i < model->inputs.size(); ++i)
      wanted = wanted || (model->inputs[i].name == use.input && read_between_rows(*model, i));
    if (!use.rule && wanted) diagnostics.add(errors::rule_missing(use.rule_span, use.input, input_rule_names()));
  }
}

namespace {

void add_declared(ast::Dictionary const& dictionary, DeclaredNames& names) {
  for (ast::DictionaryStatement const& statement : dictionary.statements) {
    if (auto const* input = std::get_if<ast::InputDeclaration>(&statement))
      for (ast::Declared const& each : input->names) names.inputs.insert(each.name.text);
    if (auto const* states = std::get_if<ast::DictionaryStates>(&statement))
      for (ast::DictionaryState const& each : states->states)
        if (each.channel) names.channels.insert(each.channel->text);
  }
}

}  // namespace

DeclaredNames declared_names(ast::File const& file) {
  DeclaredNames names;
  for (ast::Item const& item : file.items) {
    if (auto const* dictionary = std::get_if<ast::Dictionary>(&item)) add_declared(*dictionary, names);
    auto const* model = std::get_if<ast::Model>(&item);
    if (model == nullptr) continue;
    for (ast::ModelStatement const& statement : model->statements) {
      if (auto const* input = std::get_if<ast::InputDeclaration>(&statement))
        for (ast::Declared const& each : input->names) names.inputs.insert(each.name.text);
      if (auto const* observation = std::get_if<ast::Observation>(&statement))
        names.channels.insert(observation->channel.name.text);
      if (auto const* parameter = std::get_if<ast::ParameterDeclaration>(&statement))
        names.parameters.insert(parameter->name.name.text);
    }
  }
  return names;
}

void check_binding(DataBlock const& block, Model const& model, std::string const& noun, DeclaredNames const& declared, Span use,
                   Diagnostics& diagnostics) {
  errors::Subject const owner = errors::named(noun, model.name);
  auto const compare_units = [&](ColumnUse const& column, Quantity const& declared, errors::Subject const& what) {
    if (!column.unit || !declared.unit) return;
    std::string const wanted = declared.unit->text_or_dimension();
    // A column in [-] for a channel in [deg] would be read as radians; one in [mm/m] says how it counts.
    bool const unsaid_angle = declared.unit->dimensionless() && declared.unit->radian.numerator == 1 && declared.unit->scale != 1 &&
                              column.unit->dimensionless() && column.unit->radian.numerator == 0 && column.unit->scale == 1;
    if (column.unit->dimension != declared.unit->dimension || zero_against_difference(*column.unit, *declared.unit) || unsaid_angle)
      diagnostics.add(errors::unit_mismatch(column.span, what, column.unit->text, wanted));
    else if (cycles_against_radians(*column.unit, *declared.unit))
      diagnostics.add(data_errors::cycles_against_radians(column.column, column.unit->text, wanted, column.span));
  };
  check_between_samples(block, &model, diagnostics);
  std::vector<std::string> inputs;
  for (Quantity const& input : model.inputs) inputs.push_back(input.name);
  bool misnamed = false;
  for (DataInputUse const& bound : block.inputs) {
    if (!declared.all || declared.inputs.contains(bound.input)) continue;
    misnamed = true;
    diagnostics.add_once(errors::unknown_input(bound.input_span, bound.input, bound.unit ? bound.unit->text : "", owner, inputs));
  }
  for (std::size_t i = 0; i < model.inputs.size(); ++i) {
    Quantity const& input = model.inputs[i];
    auto const bound =
        std::find_if(block.inputs.begin(), block.inputs.end(), [&](auto const& each) { return each.input == input.name; });
    if (bound == block.inputs.end()) {
      if (!misnamed) diagnostics.add(errors::input_not_bound(use, input.name, owner, block.name));
      continue;
    }
    compare_units(*bound, input, errors::named("column", bound->column));
    if (!bound->rule || row_of(*bound->rule).has_rate) continue;
    for (NodeId id = 0; id < model.graph.size(); ++id) {
      Node const& node = model.graph[id];
      if (node.operation == Operation::leaf && node.leaf_kind == LeafKind::input_rate && node.index == static_cast<int>(i)) {
        diagnostics.add(errors::rate_under_zero_order(bound->rule_span, model.graph.span(id).value_or(input.span), input.name,
                                                      rules_with_rate()));
        break;
      }
    }
  }
  std::vector<std::string> channels;
  for (Channel const& channel : model.channels) channels.push_back(channel.name);
  auto const unknown = [&](DataMeasureUse const& measured) {
    return block.measured.size() == 1 && channels.size() == 1
               ? errors::channel_of_other_name(measured.channel_span, measured.channel, owner, channels.front(),
                                               {measured.column, measured.unit ? measured.unit->text : ""})
               : errors::unknown_channel(measured.channel_span, measured.channel, owner, channels);
  };
  bool any = false;
  for (DataMeasureUse const& measured : block.measured) {
    auto const channel =
        std::find_if(model.channels.begin(), model.channels.end(), [&](auto const& each) { return each.name == measured.channel; });
    // A block may serve several models.
    if (channel == model.channels.end() && (!declared.all || declared.channels.contains(measured.channel))) continue;
    any = true;
    if (channel != model.channels.end())
      compare_units(measured, *channel, errors::named("column", measured.column));
    else
      diagnostics.add_once(unknown(measured));
  }
  if (any) return;
  if (block.measured.empty()) {
    diagnostics.add(errors::no_channel_bound(use, owner, block.name, channels));
  } else {
    for (DataMeasureUse const& measured : block.measured) diagnostics.add(unknown(measured));
  }
}

std::vector<std::optional<double>> check_constants(DataBlock const& block, Model const& model, DeclaredNames const& declared,
                                                   Span use, Diagnostics& diagnostics) {
  std::vector<std::optional<double>> values(model.parameters.size());
  bool good = true;
  for (DataConstantUse const& constant : block.constants) {
    auto const place = std::find_if(model.parameters.begin(), model.parameters.end(),
                                    [&](Parameter const& each) { return each.name == constant.parameter; });
    if (place == model.parameters.end()) {
      // A block may serve several models.
      if (!declared.all || declared.parameters.contains(constant.parameter)) continue;
      std::vector<std::string> known;
      for (Parameter const& parameter : model.parameters)
        if (parameter.per_experiment) known.push_back(parameter.name);
      diagnostics.add_once(errors::constant_of_nothing(constant.span, constant.parameter, model.name, known));
      good = false;
    } else if (!place->per_experiment) {
      diagnostics.add_once(errors::constant_of_shared(constant.span, place->span, place->name));
      good = false;
    } else if (auto refused = constant.unit && place->unit
                                  ? refuse_number(constant.value_span, errors::named("the constant", place->name), *constant.unit,
                                                  *place->unit)
                                  : std::nullopt) {
      diagnostics.add_once(std::move(*refused));
      good = false;
    } else {
      double const shift = constant.unit && place->unit ? constant.unit->offset - place->unit->offset : 0;
      values[static_cast<std::size_t>(place - model.parameters.begin())] =
          constant.unit ? constant.value + shift : place->to_si(constant.value);
    }
  }
  for (std::size_t p = 0; p < values.size() && good; ++p) {
    Parameter const& parameter = model.parameters[p];
    if (parameter.per_experiment && !parameter.prior && !parameter.value && !values[p])
      diagnostics.add(errors::constant_missing(use, parameter.span, parameter.name, block.name));
  }
  return values;
}

}  // namespace sysid
