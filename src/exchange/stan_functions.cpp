// One function after the other, each a string of Stan.
#include "exchange/stan_functions.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/numeric/elementary.hpp"
#include "exchange/stan_text.hpp"
#include "model/state_jacobian.hpp"

namespace sysid {
namespace {

class Functions {
 public:
  Functions(StanFit const& fit, StanColumns& columns)
      : fit_(fit), columns_(columns), model_(fit.model()), graph_(fit.model().graph) {}

  std::string operator()() {
    std::string text = fmt::format("functions {{\n{}", stan_own_functions());
    text += equations();
    for (std::size_t c = 0; c < model_.channels.size(); ++c) text += channel_density(c);
    if (fit_.exact())
      text += exact_steps();
    else if (fit_.steps())
      text += runge_kutta();
    return text + prior() + likelihood() + "}\n";
  }

 private:
  std::string leaf_text(NodeId id) {
    Node const& leaf = graph_[id];
    switch (leaf.leaf_kind) {
      case LeafKind::parameter:
        return fmt::format("p[{}]", leaf.index + 1);
      case LeafKind::state:
        return fmt::format("y[{}]", leaf.index + 1);
      case LeafKind::measured:
        if (leaf.lag == 0) return "measured";
        return columns_.text(leaf, "d");
      case LeafKind::input:
      case LeafKind::input_rate:
      case LeafKind::time:
        return columns_.text(leaf, "d");
      default:
        throw not_carried(fit_.task, "it depends on algebraic unknowns of the equations", "write it without algebraic unknowns");
    }
  }

  StanExpressions written(Graph const& graph, std::vector<NodeId> const& roots, StanLeaves const& leaves) const {
    if (auto const lacking = lacking_in_stan(graph, roots))
      throw not_carried(fit_.task, fmt::format("`{}` has no equivalent in Stan", *lacking),
                        "it may come from the bounds of a truncated distribution");
    return stan_expressions(graph, roots, leaves);
  }
  StanExpressions of_model(std::vector<NodeId> const& roots) {
    return written(graph_, roots, [this](NodeId id) { return leaf_text(id); });
  }

  // A function of the states that returns as many numbers.
  std::string vector_function(std::string const& name, std::string const& arguments, std::vector<NodeId> const& roots) {
    StanExpressions const written = of_model(roots);
    std::string text =
        fmt::format("  vector {}({}) {{\n{}    vector[{}] result;\n", name, arguments, written.declarations, roots.size());
    for (std::size_t i = 0; i < roots.size(); ++i) text += fmt::format("    result[{}] = {};\n", i + 1, written.texts[i]);
    return text + "    return result;\n  }\n";
  }

  std::string equations() {
    if (model_.states.empty()) return "";
    std::vector<NodeId> derivative, initial;
    std::vector<std::string> names;
    for (State const& state : model_.states) {
      derivative.push_back(state.derivative);
      initial.push_back(state.initial);
      names.push_back(state.name);
    }
    std::string text = "  // The state at the first sample.\n" + vector_function("initial", "row_vector d, vector p", initial);
    text += fmt::format("  // {}{}\n", fit_.steps() ? "Time derivatives of " : "At the next sample: ", fmt::join(names, ", "));
    return text + vector_function(fit_.steps() ? "derivative" : "next_state", "vector y, row_vector d, vector p", derivative);
  }

  std::string channel_density(std::size_t c) {
    Channel const& channel = model_.channels[c];
    NodeId density = log_density(graph_, channel.noise, graph_.leaf(LeafKind::measured, static_cast<int>(c)));
    if (channel.unit && !channel.noise.row->discrete)
      density = graph_.add(density, graph_.constant(elementary::log(channel.unit->scale)));
    StanExpressions const written = of_model({density});
    return fmt::format(
        "  // Of a sample of {}, a density of its declared unit.\n  real log_density_{}(real measured{}, row_vector "
        "d, vector p) {{\n{}    return {};\n  }}\n",
        channel.name, c + 1, fit_.states() > 0 ? ", vector y" : "", written.declarations, written.texts.front());
  }

  std::string runge_kutta() const {
    int const k = columns_.count();
    return fmt::format(R"(  // One step of the classical Runge-Kutta method; d: what is read at its begin, middle and end.
  vector rk4(vector y, row_vector d, real h, vector p) {{
    vector[{0}] k1 = derivative(y, segment(d, 1, {1}), p);
    vector[{0}] k2 = derivative(y + h / 2 * k1, segment(d, {2}, {1}), p);
    vector[{0}] k3 = derivative(y + h / 2 * k2, segment(d, {2}, {1}), p);
    vector[{0}] k4 = derivative(y + h * k3, segment(d, {3}, {1}), p);
    return y + h / 6 * (k1 + k4 + 2 * (k2 + k3));
  }}
)",
                       fit_.states(), k, k + 1, 2 * k + 1);
  }

  // The derivatives of all states by all states, which are of parameters alone.
  std::string state_matrix() {
    int const n = fit_.states();
    std::vector<NodeId> const entries = state_jacobian(graph_, model_);
    StanExpressions const written = of_model(entries);
    std::string text = fmt::format(
        "  // The coefficients of the states in their time derivatives.\n  matrix state_matrix(vector p) {{\n{0}"
        "    matrix[{1}, {1}] result = rep_matrix(0, {1}, {1});\n",
        written.declarations, n);
    for (int i = 0; i < n * n; ++i)
      if (!graph_.is_constant(entries[static_cast<std::size_t>(i)], 0))
        text += fmt::format("    result[{}, {}] = {};\n", i / n + 1, i % n + 1, written.texts[static_cast<std::size_t>(i)]);
    return text + "    return result;\n  }\n";
  }

  // Van Loan 1978: the functions of h A are blocks of one exponential.
  std::string exact_steps() {
    int const k = columns_.count();
    return state_matrix() + fmt::format(R"(  // exp(h A), phi_1(h A) and phi_2(h A) side by side, A the matrix of the states.
  matrix step_functions(real h, vector p) {{
    matrix[{1}, {1}] m = rep_matrix(0, {1}, {1});
    m[1:{0}, 1:{0}] = h * state_matrix(p);
    for (i in 1:{2}) m[i, {0} + i] = 1;
    return block(matrix_exp(m), 1, 1, {0}, {1});
  }}
  // One step without an error; d: what is read at its begin, middle and end, of which a straight line is followed.
  vector exact_step(vector y, row_vector d, real h, matrix functions_of_h, vector p) {{
    vector[{0}] at_begin = derivative(rep_vector(0, {0}), segment(d, 1, {3}), p);
    vector[{0}] at_end = derivative(rep_vector(0, {0}), segment(d, {4}, {3}), p);
    return block(functions_of_h, 1, 1, {0}, {0}) * y
           + h * (block(functions_of_h, 1, {5}, {0}, {0}) * at_begin + block(functions_of_h, 1, {6}, {0}, {0}) * (at_end - at_begin));
  }}
)",
                                        fit_.states(), 3 * fit_.states(), 2 * fit_.states(), k, 2 * k + 1, fit_.states() + 1,
                                        2 * fit_.states() + 1);
  }

  // Density of a sampled parameter in its declared unit. Leaves are rows of the space: those that every experiment has for itself
  // differ.
  NodeId prior_density(Graph& graph, int r) const {
    FittedParameter const& row = fit_.space->rows()[static_cast<std::size_t>(r)];
    Distribution use = *model_.parameters[static_cast<std::size_t>(row.parameter)].prior;
    auto const placed = [&](NodeId root) {
      return graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
        Node const node = graph[leaf];
        if (node.leaf_kind != LeafKind::parameter) return std::nullopt;
        return graph.leaf(LeafKind::state, fit_.space->row(std::max(row.experiment, 0), node.index));
      });
    };
    for (NodeId& argument : use.arguments) argument = placed(argument);
    if (use.lower) use.lower = placed(*use.lower);
    if (use.upper) use.upper = placed(*use.upper);
    Support const support = sysid::support(graph, use);
    for (std::optional<NodeId> const& bound : {support.lower, support.upper})
      if (bound && !graph.constant_value(*bound))
        throw not_carried(fit_.task, fmt::format("the bounds of `{}` depend on other parameters", row.name),
                          "give it a prior with fixed bounds");
    NodeId const density = log_density(graph, use, graph.leaf(LeafKind::state, r));
    return row.unit ? graph.add(density, graph.constant(elementary::log(row.unit->scale))) : density;
  }

  // Over all sampled parameters; si: their SI values and those that are fixed.
  std::string prior() const {
    Graph graph = model_.graph;
    std::vector<NodeId> roots;
    for (int const r : fit_.space->sampled()) roots.push_back(prior_density(graph, r));
    StanExpressions const densities = written(graph, roots, [&](NodeId id) { return fmt::format("si[{}]", graph[id].index + 1); });
    std::string text = "  real log_prior(vector si) {\n" + densities.declarations + "    return 0.0";
    for (std::size_t k = 0; k < roots.size(); ++k)
      text += fmt::format("\n        + {}  // {}", densities.texts[k],
                          fit_.space->rows()[static_cast<std::size_t>(fit_.space->sampled()[k])].name);
    return text + "\n        ;\n  }\n";
  }

  std::string likelihood() const {
    bool const states = fit_.states() > 0;
    std::string text = "  real log_likelihood(matrix samples, matrix measured, matrix scored, ";
    if (fit_.steps()) text += fmt::format("matrix stages, vector h, {}", fit_.exact() ? "" : "int substeps, ");
    text += "vector p) {\n    real total = 0;\n";
    if (fit_.exact()) text += fmt::format("    matrix[{}, {}] functions_of_h;\n", fit_.states(), 3 * fit_.states());
    if (states) text += fmt::format("    vector[{}] y = initial(samples[1], p);\n", fit_.states());
    text += "    for (i in 1:rows(samples)) {\n";
    for (std::size_t c = 1; c <= model_.channels.size(); ++c)
      text += fmt::format("      if (scored[i, {0}] > 0) total += log_density_{0}(measured[i, {0}]{1}, samples[i], p);\n", c,
                          states ? ", y" : "");
    if (fit_.exact())
      text +=
          "      if (i < rows(samples)) {\n"
          "        if (i == 1 || h[i] != h[i - 1]) functions_of_h = step_functions(h[i], p);\n"
          "        y = exact_step(y, stages[i], h[i], functions_of_h, p);\n      }\n";
    else if (fit_.steps())
      text +=
          "      if (i < rows(samples))\n        for (k in 1:substeps)\n"
          "          y = rk4(y, stages[(i - 1) * substeps + k], h[(i - 1) * substeps + k], p);\n";
    else if (states)
      text += "      if (i < rows(samples)) y = next_state(y, samples[i], p);\n";
    return text + "    }\n    return total;\n  }\n";
  }

  StanFit const& fit_;
  StanColumns& columns_;
  Model const& model_;
  Graph graph_;  // grows by densities
};

}  // namespace

std::string stan_functions_block(StanFit const& fit, StanColumns& columns) { return Functions(fit, columns)(); }

std::vector<std::string> stan_function_names(StanFit const& fit) {
  std::vector<std::string> names = {"si",
                                    "p",
                                    "absolute_value",
                                    "sign_of",
                                    "derivative",
                                    "rk4",
                                    "initial",
                                    "next_state",
                                    "log_prior",
                                    "log_likelihood",
                                    "substeps",
                                    "state_matrix",
                                    "step_functions",
                                    "exact_step"};
  for (std::size_t c = 0; c < fit.model().channels.size(); ++c) names.push_back(fmt::format("log_density_{}", c + 1));
  return names;
}

}  // namespace sysid
