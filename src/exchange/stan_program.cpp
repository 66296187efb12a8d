// The blocks of the program, one after the other.
#include "exchange/stan_program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/experiments.hpp"
#include "app/reporting.hpp"
#include "core/diagnostic.hpp"
#include "core/elementary.hpp"
#include "exchange/stan_text.hpp"
#include "report/number.hpp"
#include "simulate/schedule.hpp"

namespace sysid {
namespace {

using Json = nlohmann::ordered_json;

/// What the equations read of the record, as columns of the data. The first is time, so that there is one.
class Columns {
 public:
  std::string text(Node const& leaf, std::string_view row) {
    auto const same = [&](UniformLeaf const& each) {
      return each.kind == leaf.leaf_kind && each.index == leaf.index && each.lag == leaf.lag;
    };
    auto place = std::find_if(leaves_.begin(), leaves_.end(), same);
    if (place == leaves_.end())
      place = leaves_.insert(leaves_.end(), {leaf.leaf_kind, leaf.index, Stage::begin, static_cast<int>(leaf.lag)});
    return fmt::format("{}[{}]", row, place - leaves_.begin() + 1);
  }
  std::vector<UniformLeaf> const& leaves() const { return leaves_; }
  int count() const { return static_cast<int>(leaves_.size()); }

 private:
  std::vector<UniformLeaf> leaves_ = {{LeafKind::time, 0, Stage::begin, 0}};
};

class Export {
 public:
  Export(Session& session, Task const& task, SolverSettings const& solver)
      : session_(session),
        task_(task),
        what_(std::get<FitTask>(task.what)),
        solver_(solver),
        compiled_(carried()),
        model_(compiled_->model),
        space_(parameter_space(model_, what_.experiments)),
        data_(load_experiments(session, what_.experiments, session.file.models[static_cast<std::size_t>(what_.model)], what_.start,
                               what_.prediction)),
        graph_(model_.graph) {
    for (char const* name : {"si", "p", "absolute_value", "sign_of", "derivative", "rk4", "initial", "next_state", "log_prior",
                             "log_likelihood", "substeps"})
      taken_.push_back(name);
    for (std::size_t c = 0; c < model_.channels.size(); ++c) taken_.push_back(fmt::format("log_density_{}", c + 1));
  }

  StanProgram operator()() {
    std::string const functions = functions_block();
    StanProgram out;
    Json data = Json::object();
    std::string const declarations = data_block(data);
    std::string const parameters = parameters_block();
    out.program = head() + functions + declarations + parameters + model_block();
    out.data = data.dump() + "\n";
    return out;
  }

 private:
  UserError refused(std::string what, std::string help) const {
    return UserError({Severity::error,
                      "",
                      fmt::format("`{}` cannot be written as a Stan program: {}", task_.name, what),
                      Label{task_.span, {}},
                      {},
                      std::move(help)});
  }

  // What the task would be compiled to, or a refusal.
  std::shared_ptr<CompiledModel const> carried() const {
    Model const& model = session_.file.models[static_cast<std::size_t>(what_.model)];
    if (!model.processes.empty())
      throw refused(fmt::format("`{}` is a Gaussian process over its rows", model.processes.front().name),
                    "its covariance is not written out");
    if (what_.start.kind == StartRule::Kind::estimated)
      throw refused("its start is estimated within the likelihood", "state `start = record` or `start = rest`");
    if (model.implicit)
      throw refused("its equations are not solved for the highest derivatives", "write it without what is determined implicitly");
    if (model.integrated() && solver_.method != "rk4")
      throw refused(fmt::format("it is integrated by {}", solver_.method),
                    "state `solver = rk4`, with as many substeps as it needs");
    auto compiled = session_.compiled(what_.model, false, solver_.method, what_.prediction);
    if (!compiled->model.memories.empty())
      throw refused("it remembers values from row to row", "write it without `since_last` and its like");
    return compiled;
  }

  int states() const { return static_cast<int>(model_.states.size()); }
  bool steps() const { return model_.integrated(); }

  // Leaves inside a function of states y, a row d of data, parameters p and a sample `measured`.
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
        throw refused("it reads what the equations determine beside the states", "write it without algebraic unknowns");
    }
  }

  StanExpressions expressions(std::vector<NodeId> const& roots) {
    return stan_expressions(graph_, roots, [this](NodeId id) { return leaf_text(id); });
  }

  std::string head() const {
    return fmt::format(
        "// {0}: {1}\n// Written by sysid {2}. target, without the adjustment for transforms, is the log density of the "
        "parameters\n"
        "// in their declared units with all constants: log_prior__ + log_likelihood__ of the draws. Equations are in SI units.\n",
        task_.name, fmt::format("{} fitted to {}", model_.name, data_names(session_.file, what_.experiments)), SYSID_VERSION);
  }

  // A function of the states that returns as many numbers.
  std::string vector_function(std::string const& name, std::string const& arguments, std::vector<NodeId> const& roots) {
    StanExpressions const written = expressions(roots);
    std::string text =
        fmt::format("  vector {}({}) {{\n{}    vector[{}] result;\n", name, arguments, written.declarations, roots.size());
    for (std::size_t i = 0; i < roots.size(); ++i) text += fmt::format("    result[{}] = {};\n", i + 1, written.texts[i]);
    return text + "    return result;\n  }\n";
  }

  std::string functions_block() {
    std::string text = fmt::format("functions {{\n{}", stan_functions());
    std::vector<NodeId> derivative, initial;
    for (State const& state : model_.states) {
      derivative.push_back(state.derivative);
      initial.push_back(state.initial);
    }
    if (states() > 0) {
      text += "  // The state at the first sample.\n" + vector_function("initial", "row_vector d, vector p", initial);
      text += steps() ? "  // Time derivatives of " : "  // At the next sample: ";
      for (int s = 0; s < states(); ++s) text += (s == 0 ? "" : ", ") + model_.states[static_cast<std::size_t>(s)].name;
      text += "\n" + vector_function(steps() ? "derivative" : "next_state", "vector y, row_vector d, vector p", derivative);
    }
    for (std::size_t c = 0; c < model_.channels.size(); ++c) {
      Channel const& channel = model_.channels[c];
      NodeId density = log_density(graph_, channel.noise, graph_.leaf(LeafKind::measured, static_cast<int>(c)));
      if (channel.unit && !channel.noise.row->discrete)
        density = graph_.add(density, graph_.constant(elementary::log(channel.unit->scale)));
      StanExpressions const written = expressions({density});
      text += fmt::format(
          "  // Of a sample of {}, a density of its declared unit.\n  real log_density_{}(real measured{}, row_vector "
          "d, vector p) {{\n{}    return {};\n  }}\n",
          channel.name, c + 1, states() > 0 ? ", vector y" : "", written.declarations, written.texts.front());
    }
    if (steps()) text += rk4();
    return text + prior() + likelihood() + "}\n";
  }

  std::string rk4() const {
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
                       states(), k, k + 1, 2 * k + 1);
  }

  // Densities of the declared units, over all sampled parameters; p: their SI values and those that are fixed.
  std::string prior() {
    std::vector<NodeId> roots;
    Graph graph = model_.graph;
    for (int const r : space_->sampled()) {
      FittedParameter const& row = space_->rows()[static_cast<std::size_t>(r)];
      Distribution use = *model_.parameters[static_cast<std::size_t>(row.parameter)].prior;
      int const experiment = std::max(row.experiment, 0);
      // A leaf for each row: those that every experiment has for itself differ.
      auto const placed = [&](NodeId root) {
        return graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
          Node const node = graph[leaf];
          if (node.leaf_kind != LeafKind::parameter) return std::nullopt;
          return graph.leaf(LeafKind::state, space_->row(experiment, node.index));
        });
      };
      for (NodeId& argument : use.arguments) argument = placed(argument);
      if (use.lower) use.lower = placed(*use.lower);
      if (use.upper) use.upper = placed(*use.upper);
      Support const support = sysid::support(graph, use);
      for (std::optional<NodeId> const& bound : {support.lower, support.upper})
        if (bound && !graph.constant_value(*bound))
          throw refused(fmt::format("the bounds of `{}` depend on other parameters", row.name),
                        "give it a prior with fixed bounds");
      NodeId density = log_density(graph, use, graph.leaf(LeafKind::state, r));
      if (row.unit) density = graph.add(density, graph.constant(elementary::log(row.unit->scale)));
      roots.push_back(density);
    }
    StanExpressions const written =
        stan_expressions(graph, roots, [&](NodeId id) { return fmt::format("si[{}]", graph[id].index + 1); });
    std::string text = "  real log_prior(vector si) {\n" + written.declarations + "    return 0.0";
    for (std::size_t k = 0; k < roots.size(); ++k)
      text += fmt::format("\n        + {}  // {}", written.texts[k],
                          space_->rows()[static_cast<std::size_t>(space_->sampled()[k])].name);
    return text + "\n        ;\n  }\n";
  }

  std::string likelihood() const {
    std::string text = "  real log_likelihood(matrix samples, matrix measured, matrix scored, ";
    if (steps()) text += "matrix stages, vector h, int substeps, ";
    text += "vector p) {\n    real total = 0;\n";
    if (states() > 0) text += fmt::format("    vector[{}] y = initial(samples[1], p);\n", states());
    text += "    for (i in 1:rows(samples)) {\n";
    for (std::size_t c = 1; c <= model_.channels.size(); ++c)
      text += fmt::format("      if (scored[i, {0}] > 0) total += log_density_{0}(measured[i, {0}]{1}, samples[i], p);\n", c,
                          states() > 0 ? ", y" : "");
    if (steps())
      text +=
          "      if (i < rows(samples))\n        for (k in 1:substeps)\n"
          "          y = rk4(y, stages[(i - 1) * substeps + k], h[(i - 1) * substeps + k], p);\n";
    else if (states() > 0)
      text += "      if (i < rows(samples)) y = next_state(y, samples[i], p);\n";
    return text + "    }\n    return total;\n  }\n";
  }

  std::string data_block(Json& data) {
    std::string text = "data {\n";
    text += "  // columns:";
    for (UniformLeaf const& leaf : columns_.leaves()) {
      auto const index = static_cast<std::size_t>(leaf.index);
      text += fmt::format("{}{}{}", &leaf == &columns_.leaves().front() ? " " : ", ",
                          leaf.kind == LeafKind::time         ? std::string("time")
                          : leaf.kind == LeafKind::measured   ? model_.channels[index].name
                          : leaf.kind == LeafKind::input_rate ? model_.inputs[index].name + "'"
                                                              : model_.inputs[index].name,
                          leaf.lag > 0 ? fmt::format(" {} samples before", leaf.lag) : "");
    }
    text += "\n";
    int const substeps = steps() ? solver_.substeps : 1;
    if (steps()) {
      text += "  int<lower=1> substeps;\n";
      data["substeps"] = substeps;
    }
    for (ExperimentData const& each : data_) {
      std::string const suffix = data_.size() > 1 ? "_" + each.use.name : "";
      Names names{stan_identifier("samples" + suffix, taken_), stan_identifier("measured" + suffix, taken_),
                  stan_identifier("scored" + suffix, taken_),  stan_identifier("stages" + suffix, taken_),
                  stan_identifier("h" + suffix, taken_),       stan_identifier("N" + suffix, taken_)};
      SolverSettings solver = solver_;
      if (!steps()) solver = SolverSettings{};
      Schedule const schedule(*compiled_->likelihood, each.experiment, solver);
      int const rows = schedule.last_summed(), channels = static_cast<int>(model_.channels.size());
      Json samples = Json::array(), measured = Json::array(), scored = Json::array(), stages = Json::array(), h = Json::array();
      for (int i = 0; i < rows; ++i) {
        Json sample = Json::array(), values = Json::array(), flags = Json::array();
        for (UniformLeaf const& leaf : columns_.leaves()) sample.push_back(finite(schedule.at_sample(leaf, i)));
        for (int c = 0; c < channels; ++c) {
          bool const there = schedule.summed(c, i);
          values.push_back(there ? each.experiment.measured[static_cast<std::size_t>(c)][static_cast<std::size_t>(i)] : 0.0);
          flags.push_back(there ? 1 : 0);
        }
        samples.push_back(sample);
        measured.push_back(values);
        scored.push_back(flags);
        for (int k = 0; steps() && k < substeps && i + 1 < rows; ++k) {
          Json row = Json::array();
          for (Stage const stage : {Stage::begin, Stage::middle, Stage::end})
            for (UniformLeaf leaf : columns_.leaves()) {
              leaf.stage = stage;
              // What observations alone read has no value between the samples.
              row.push_back(leaf.kind == LeafKind::measured || leaf.lag > 0 ? 0.0 : schedule.at_step(leaf, i, k));
            }
          stages.push_back(row);
          h.push_back(schedule.at_step({LeafKind::step_size, 0, Stage::begin, 0}, i, k));
        }
      }
      text += fmt::format("  int<lower=1> {};\n  matrix[{}, {}] {};\n  matrix[{}, {}] {};\n  matrix[{}, {}] {};\n", names.count,
                          names.count, columns_.count(), names.samples, names.count, channels, names.measured, names.count,
                          channels, names.scored);
      data[names.count] = rows;
      data[names.samples] = samples;
      data[names.measured] = measured;
      data[names.scored] = scored;
      if (steps()) {
        text += fmt::format("  matrix[({0} - 1) * substeps, {1}] {2};\n  vector[({0} - 1) * substeps] {3};\n", names.count,
                            3 * columns_.count(), names.stages, names.h);
        data[names.stages] = stages;
        data[names.h] = h;
      }
      names_.push_back(names);
    }
    return text + "}\n";
  }

  // A sample of an input that is never read where it is missing.
  static double finite(double value) { return std::isfinite(value) ? value : 0.0; }

  std::string parameters_block() {
    std::string text = "parameters {\n", si = fmt::format("transformed parameters {{\n  vector[{}] si;\n", space_->rows().size());
    std::vector<PriorInfo> const priors = priors_of(*space_, declared_priors(session_, what_.model));
    std::size_t next = 0;
    for (std::size_t r = 0; r < space_->rows().size(); ++r) {
      FittedParameter const& row = space_->rows()[r];
      if (row.value) {
        si += fmt::format("  si[{}] = {};  // {}\n", r + 1, stan_real(*row.value), row.name);
        continue;
      }
      ParameterInfo const& info = space_->infos()[next];
      std::string bounds;
      if (std::isfinite(info.lower)) bounds = "lower=" + stan_real(info.lower);
      if (std::isfinite(info.upper)) bounds += (bounds.empty() ? "" : ", ") + ("upper=" + stan_real(info.upper));
      std::string const name = stan_identifier(row.name, taken_);
      auto const prior = std::find_if(priors.begin(), priors.end(), [&](PriorInfo const& each) { return each.name == row.name; });
      text += fmt::format("  real{} {};  // {}{}{}\n", bounds.empty() ? "" : "<" + bounds + ">", name, row.name,
                          row.unit ? " [" + row.unit_text() + "]" : "", prior == priors.end() ? "" : " ~ " + prior->text);
      si += row.unit && row.unit->scale != 1 ? fmt::format("  si[{}] = {} * {};\n", r + 1, name, stan_real(row.unit->scale))
                                             : fmt::format("  si[{}] = {};\n", r + 1, name);
      ++next;
    }
    return text + "}\n" + si + "}\n";
  }

  std::string model_block() const {
    std::string text = "model {\n  target += log_prior(si);\n";
    for (std::size_t e = 0; e < data_.size(); ++e) {
      Names const& names = names_[e];
      text += fmt::format("  {{\n    vector[{}] p;\n", std::max<std::size_t>(1, model_.parameters.size()));
      for (std::size_t p = 0; p < model_.parameters.size(); ++p)
        text += fmt::format("    p[{}] = si[{}];\n", p + 1, space_->row(static_cast<int>(e), static_cast<int>(p)) + 1);
      text += fmt::format("    target += log_likelihood({}, {}, {}, {}p);\n  }}\n", names.samples, names.measured, names.scored,
                          steps() ? fmt::format("{}, {}, substeps, ", names.stages, names.h) : "");
    }
    return text + "}\n";
  }

  struct Names {
    std::string samples, measured, scored, stages, h, count;
  };

  Session& session_;
  Task const& task_;
  FitTask const& what_;
  SolverSettings solver_;
  std::shared_ptr<CompiledModel const> compiled_;
  Model const& model_;
  std::shared_ptr<ParameterSpace const> space_;
  std::vector<ExperimentData> data_;
  Graph graph_;
  Columns columns_;
  std::vector<std::string> taken_;
  std::vector<Names> names_;
};

}  // namespace

StanProgram stan_program(Session& session, Task const& task, SolverSettings const& solver) {
  return Export(session, task, solver)();
}

}  // namespace sysid
