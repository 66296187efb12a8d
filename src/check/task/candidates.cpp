// Candidates by name, probabilities to their sum, shared parameters by comparing what is known of them before the data.
#include "check/task/candidates.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "check/expression/option_reader.hpp"
#include "check/message/errors.hpp"
#include "syntax/find_model.hpp"

namespace sysid {
namespace {

constexpr double sum_tolerance = 1e-9;

/// A parameter of one of the candidates, and where its prior or value stands.
struct Use {
  Model const* model = nullptr;
  Parameter const* parameter = nullptr;
  Span span;
};

// The same expression of constants and of parameters of the same names. Operands that commute stand in the order of their graph.
bool same(Model const& one, NodeId a, Model const& other, NodeId b) {
  Node const &left = one.graph[a], &right = other.graph[b];
  if (left.operation != right.operation) return false;
  if (left.operation == Operation::constant)
    return std::bit_cast<std::uint64_t>(left.value) == std::bit_cast<std::uint64_t>(right.value);
  if (left.operation == Operation::leaf)
    return left.leaf_kind == LeafKind::parameter && right.leaf_kind == LeafKind::parameter &&
           one.parameters[static_cast<std::size_t>(left.index)].name ==
               other.parameters[static_cast<std::size_t>(right.index)].name;
  if (left.function != right.function) return false;
  int const count = operand_count(left);
  bool const straight = (count < 1 || same(one, left.a, other, right.a)) && (count < 2 || same(one, left.b, other, right.b)) &&
                        (count < 3 || same(one, left.c, other, right.c));
  bool const commutes = left.operation == Operation::add || left.operation == Operation::multiply;
  return straight || (commutes && same(one, left.a, other, right.b) && same(one, left.b, other, right.a));
}

bool same(Model const& one, std::optional<NodeId> a, Model const& other, std::optional<NodeId> b) {
  return a.has_value() == b.has_value() && (!a || same(one, *a, other, *b));
}

// Known to be the same before the data: kind, prior or value.
bool same_prior(Use const& one, Use const& other) {
  Parameter const &a = *one.parameter, &b = *other.parameter;
  if (a.per_experiment != b.per_experiment || a.prior.has_value() != b.prior.has_value()) return false;
  if (!same(*one.model, a.value, *other.model, b.value)) return false;
  if (!a.prior) return true;
  if (a.prior->row != b.prior->row || a.prior->arguments.size() != b.prior->arguments.size()) return false;
  for (std::size_t i = 0; i < a.prior->arguments.size(); ++i)
    if (!same(*one.model, a.prior->arguments[i], *other.model, b.prior->arguments[i])) return false;
  return same(*one.model, a.prior->lower, *other.model, b.prior->lower) &&
         same(*one.model, a.prior->upper, *other.model, b.prior->upper);
}

bool same_unit(Parameter const& a, Parameter const& b) {
  return a.unit.has_value() == b.unit.has_value() &&
         (!a.unit ||
          (a.unit->dimension == b.unit->dimension && a.unit->scale == b.unit->scale && a.unit->offset == b.unit->offset));
}

class CandidatesChecker {
 public:
  CandidatesChecker(ast::Candidates const& tree, std::map<std::string, std::optional<int>> const& models, CheckedFile const& file,
                    Diagnostics& diagnostics)
      : tree_(tree), models_(models), file_(file), diagnostics_(diagnostics), before_(diagnostics.all().size()) {}

  std::optional<CandidateSet> run() {
    set_.name = tree_.name.text;
    set_.title = tree_.title ? tree_.title->value : std::string();
    set_.span = tree_.name.span;
    for (ast::CandidateStatement const& statement : tree_.statements)
      if (auto const* candidate = std::get_if<ast::Candidate>(&statement)) add(*candidate);
    if (diagnostics_.has_errors(before_) || unresolved_) return std::nullopt;
    if (set_.models.empty()) {
      diagnostics_.add(errors::no_candidates(tree_.name));
      return std::nullopt;
    }
    probabilities();
    for (ast::CandidateStatement const& statement : tree_.statements)
      if (auto const* shared = std::get_if<ast::SharedParameters>(&statement))
        for (ast::Name const& name : shared->names) share(name);
    if (diagnostics_.has_errors(before_)) return std::nullopt;
    return std::move(set_);
  }

 private:
  void add(ast::Candidate const& candidate) {
    auto const model = models_.find(candidate.model.text);
    if (model == models_.end()) {
      std::vector<std::string> known;
      for (ast::Item const& item : file_.tree.items)
        if (auto const* each = std::get_if<ast::Model>(&item)) known.push_back(each->name.text);
      diagnostics_.add(errors::unknown_item(candidate.model, "model", known));
      return;
    }
    if (!model->second || !candidate.arguments.empty()) {
      unresolved_ = true;
      return;
    }
    for (CandidateModel const& before : set_.models)
      if (before.model == *model->second) {
        diagnostics_.add(errors::candidate_twice(candidate.span, before.span, before.name));
        return;
      }
    set_.models.push_back({*model->second, 0, candidate.span, candidate.model.text});
    given_.push_back(candidate.probability ? probability(*candidate.probability) : std::nullopt);
    stated_.push_back(candidate.probability.has_value());
  }

  // An expression that stands for several models is looked at once.
  std::optional<double> probability(ast::Expression const& tree) {
    auto const [place, fresh] = seen_.emplace(tree.span.begin, std::nullopt);
    if (!fresh) return place->second;
    auto const value = reader_.pure_number(tree, "probability", Unit{}, -1e300, 1e300);
    if (!value) return std::nullopt;
    if (*value > 0 && *value <= 1) return place->second = value;
    diagnostics_.add(errors::not_a_probability(tree.span, *value));
    return std::nullopt;
  }

  void probabilities() {
    double sum = 0;
    int open = 0;
    for (std::size_t i = 0; i < given_.size(); ++i) {
      if (stated_[i] && !given_[i]) return;  // said already
      sum += given_[i].value_or(0);
      open += stated_[i] ? 0 : 1;
    }
    double const rest = 1 - sum;
    if (open == 0 ? std::fabs(rest) > sum_tolerance : rest < sum_tolerance) {
      diagnostics_.add(errors::probabilities(tree_.name, sum, open, static_cast<int>(given_.size())));
      return;
    }
    for (std::size_t i = 0; i < given_.size(); ++i)
      set_.models[i].probability = given_[i] ? (open == 0 ? *given_[i] / sum : *given_[i]) : rest / open;
  }

  Span place_of(CandidateModel const& candidate, Parameter const& parameter) const {
    if (ast::Model const* const model = find_model(file_.tree, candidate.name))
      for (ast::ModelStatement const& statement : model->statements)
        if (auto const* each = std::get_if<ast::ParameterDeclaration>(&statement);
            each != nullptr && each->name.name.text == parameter.name)
          return each->prior ? each->prior->span : each->value ? each->value->span : each->name.span;
    return parameter.span;
  }

  void share(ast::Name const& name) {
    std::vector<Use> uses;
    std::vector<std::string> known;
    for (CandidateModel const& candidate : set_.models) {
      Model const& model = file_.models[static_cast<std::size_t>(candidate.model)];
      for (Parameter const& parameter : model.parameters) {
        if (std::find(known.begin(), known.end(), parameter.name) == known.end()) known.push_back(parameter.name);
        if (parameter.name == name.text) uses.push_back({&model, &parameter, place_of(candidate, parameter)});
      }
    }
    if (uses.empty()) {
      diagnostics_.add(errors::shared_by_none(name, tree_.name.text, known));
      return;
    }
    if (uses.size() < 2) {
      diagnostics_.add(errors::shared_by_one(name, uses.front().model->name));
      return;
    }
    for (Use const& use : uses)
      if (!same_unit(*use.parameter, *uses.front().parameter) || !same_prior(use, uses.front())) {
        diagnostics_.add(errors::shared_parameter_differs(name, uses.front().span, uses.front().model->name, use.span,
                                                          use.model->name, same_unit(*use.parameter, *uses.front().parameter)));
        return;
      }
    if (std::find(set_.shared.begin(), set_.shared.end(), name.text) == set_.shared.end()) set_.shared.push_back(name.text);
  }

  ast::Candidates const& tree_;
  std::map<std::string, std::optional<int>> const& models_;
  CheckedFile const& file_;
  Diagnostics& diagnostics_;
  std::size_t before_;
  OptionReader reader_{"candidates", diagnostics_};
  CandidateSet set_;
  std::vector<std::optional<double>> given_;  // per candidate
  std::vector<bool> stated_;
  std::map<std::uint32_t, std::optional<double>> seen_;
  bool unresolved_ = false;
};

}  // namespace

std::optional<CandidateSet> check_candidates(ast::Candidates const& tree, std::map<std::string, std::optional<int>> const& models,
                                             CheckedFile const& file, Diagnostics& diagnostics) {
  return CandidatesChecker(tree, models, file, diagnostics).run();
}

}  // namespace sysid
