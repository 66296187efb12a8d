// Evaluates the kernel of derived quantities for all draws, once per experiment.
#include "app/session/derived_draws.hpp"

namespace sysid {
namespace {

/// Derived quantity `quantity` of the kernel, as experiment `experiment` has it.
struct DerivedColumn {
  int quantity, experiment;
};

LaneArray declared_of(Chain const& chain, int parameters) {
  LaneArray declared(parameters, static_cast<int>(chain.values.size()));
  for (int w = 0; w < declared.width(); ++w)
    for (int p = 0; p < parameters; ++p) declared(p, w) = chain.values[static_cast<std::size_t>(w)][static_cast<std::size_t>(p)];
  return declared;
}

}  // namespace

std::string unit_of_derived(Derived const& quantity) {
  return quantity.unit && quantity.unit->dimensionless() ? quantity.unit_text() : quantity.unit_of_numbers();
}

void add_derived(CompiledModel const& compiled, ParameterSpace const& space, Draws& draws) {
  Model const& model = compiled.model;
  std::vector<DerivedColumn> columns;
  for (int d = 0; d < static_cast<int>(compiled.derived_index.size()); ++d) {
    Derived const& quantity = model.derived[static_cast<std::size_t>(compiled.derived_index[static_cast<std::size_t>(d)])];
    bool const own = reads_own_parameters(model, quantity.value);
    for (std::size_t e = 0; e < (own ? space.experiments().size() : 1); ++e) {
      columns.push_back({d, static_cast<int>(e)});
      draws.names.push_back(own ? member_name(quantity.name, space.experiments()[e].name) : quantity.name);
      draws.units.push_back(unit_of_derived(quantity));
    }
  }
  if (columns.empty()) return;
  for (Chain& chain : draws.chains) {
    LaneArray const values = space.values_of_declared(declared_of(chain, space.dimension()));
    std::vector<LaneArray> derived;
    for (int e = 0; e < static_cast<int>(space.experiments().size()); ++e) {
      LaneArray parameters(static_cast<int>(model.parameters.size()), values.width());
      space.select(values, e, parameters);
      derived.emplace_back(static_cast<int>(compiled.derived_index.size()), values.width());
      run(compiled.derived, parameters, derived.back());
    }
    for (int w = 0; w < values.width(); ++w)
      for (DerivedColumn const& column : columns)
        chain.values[static_cast<std::size_t>(w)].push_back(
            derived[static_cast<std::size_t>(column.experiment)](column.quantity, w));
  }
}

}  // namespace sysid
