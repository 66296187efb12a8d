// Sums, products and conditions of kernels: matrices and their derivatives, in strips over the processors.
#include "gaussian_process/covariance.hpp"

#include <algorithm>

#include "core/text/diagnostic.hpp"
#include "gaussian_process/conditions.hpp"
#include "gaussian_process/jet.hpp"
#include "linear_algebra/lapack.hpp"

namespace sysid::gaussian_process {

/// Works on one strip after another; holds a strip of values, and of derivatives of the result, for each node.
class Evaluation {
 public:
  Evaluation(Covariance const& covariance, Eigen::MatrixXd const& inputs, Numbers parameters)
      : covariance_(covariance),
        inputs_(inputs),
        parameters_(parameters),
        values_(strip_size, static_cast<Eigen::Index>(covariance.nodes_.size())),
        weights_(strip_size, static_cast<Eigen::Index>(covariance.nodes_.size())) {}

  /// k(x_first..., other row `right`), `size` of them.
  double const* values(Eigen::Index first, int size, Eigen::MatrixXd const& others, Eigen::Index right) {
    for (std::size_t n = 0; n < covariance_.nodes_.size(); ++n) {
      auto const& node = covariance_.nodes_[n];
      double* const out = column(values_, n);
      if (node.kind == Covariance::Node::Kind::term) {
        auto const& term = covariance_.terms_[static_cast<std::size_t>(node.left)];
        term.row->values(strip(term, first, size, others, right), parameters(term), out);
        continue;
      }
      double const* const a = column(values_, static_cast<std::size_t>(node.left));
      double const* const b = column(values_, static_cast<std::size_t>(node.right));
      if (node.kind == Covariance::Node::Kind::sum)
        for (int i = 0; i < size; ++i) out[i] = a[i] + b[i];
      else
        for (int i = 0; i < size; ++i) out[i] = a[i] * b[i];
    }
    return column(values_, covariance_.nodes_.size() - 1);
  }

  /// The derivatives of sum of weights_i k(x_i, x_right), added to `gradient`.
  void add_gradient(Eigen::Index first, int size, Eigen::Index right, double const* weights, double* gradient) {
    values(first, size, inputs_, right);
    std::copy(weights, weights + size, column(weights_, covariance_.nodes_.size() - 1));
    for (std::size_t n = covariance_.nodes_.size(); n-- > 0;) {
      auto const& node = covariance_.nodes_[n];
      double const* const own = column(weights_, n);
      if (node.kind == Covariance::Node::Kind::term) {
        auto const& term = covariance_.terms_[static_cast<std::size_t>(node.left)];
        term.row->add_gradient(strip(term, first, size, inputs_, right), parameters(term), column(values_, n), own,
                               gradient + term.first_parameter);
        continue;
      }
      auto const left = static_cast<std::size_t>(node.left), other = static_cast<std::size_t>(node.right);
      bool const product = node.kind == Covariance::Node::Kind::product;
      for (int i = 0; i < size; ++i) {
        column(weights_, left)[i] = product ? own[i] * column(values_, other)[i] : own[i];
        column(weights_, other)[i] = product ? own[i] * column(values_, left)[i] : own[i];
      }
    }
  }

 private:
  static double* column(Eigen::MatrixXd& of, std::size_t n) { return of.data() + static_cast<Eigen::Index>(n) * strip_size; }

  Numbers parameters(Covariance::Term const& term) const {
    return parameters_.subspan(static_cast<std::size_t>(term.first_parameter), static_cast<std::size_t>(term.parameter_count));
  }

  Strip strip(Covariance::Term const& term, Eigen::Index first, int size, Eigen::MatrixXd const& others, Eigen::Index right) {
    left_.clear();
    right_.clear();
    for (int const c : term.columns) {
      left_.push_back(inputs_.data() + c * inputs_.rows() + first);
      right_.push_back(others(right, c));
    }
    return {left_, right_, size};
  }

  Covariance const& covariance_;
  Eigen::MatrixXd const& inputs_;
  Numbers parameters_;
  Eigen::MatrixXd values_, weights_;  // [strip_size x nodes]
  std::vector<double const*> left_;
  std::vector<double> right_;
};

namespace {

/// Calls `work(first, size)` for the strips of rows from `from` up to `to`.
template <class Work>
void in_strips(Eigen::Index from, Eigen::Index to, Work&& work) {
  for (Eigen::Index first = from; first < to; first += strip_size)
    work(first, static_cast<int>(std::min<Eigen::Index>(strip_size, to - first)));
}

}  // namespace

Numbers Covariance::own(Known const& known, Numbers parameters) {
  return parameters.subspan(static_cast<std::size_t>(known.first_parameter),
                            static_cast<std::size_t>(known.free->parameter_count()));
}

Covariance::Covariance(KernelRow const& row, std::vector<int> columns)
    : terms_{{&row, std::move(columns), 0, 0}}, nodes_{{Node::Kind::term, 0, 0}} {
  terms_[0].parameter_count = hyper_parameter_count(row, static_cast<int>(terms_[0].columns.size()));
}

Covariance Covariance::joined(Node::Kind kind, Covariance const& left, Covariance const& right) {
  Covariance result = left;
  int const nodes = static_cast<int>(left.nodes_.size()), terms = static_cast<int>(left.terms_.size());
  for (Term term : right.terms_) {
    term.first_parameter += left.parameter_count();
    result.terms_.push_back(std::move(term));
  }
  for (Node node : right.nodes_) {
    if (node.kind == Node::Kind::term)
      node.left += terms;
    else
      node.left += nodes, node.right += nodes;
    result.nodes_.push_back(node);
  }
  result.nodes_.push_back({kind, nodes - 1, static_cast<int>(result.nodes_.size()) - 1});
  for (Known known : right.known_) {
    known.first_parameter += left.parameter_count();
    result.known_.push_back(std::move(known));
  }
  if (kind == Node::Kind::product && !result.known_.empty()) throw InternalError("a product of a covariance with conditions");
  return result;
}

Covariance operator+(Covariance const& left, Covariance const& right) {
  return Covariance::joined(Covariance::Node::Kind::sum, left, right);
}
Covariance operator*(Covariance const& left, Covariance const& right) {
  return Covariance::joined(Covariance::Node::Kind::product, left, right);
}

Covariance Covariance::conditioned(std::vector<Condition> conditions) const {
  if (!known_.empty()) throw InternalError("conditions are given twice");
  Covariance result = *this;
  if (!conditions.empty()) result.known_.push_back({std::make_shared<Covariance const>(*this), 0, std::move(conditions)});
  return result;
}

bool Covariance::is_sum() const {
  return known_.empty() &&
         std::none_of(nodes_.begin(), nodes_.end(), [](Node const& node) { return node.kind == Node::Kind::product; });
}

int Covariance::parameter_count() const { return terms_.back().first_parameter + terms_.back().parameter_count; }

std::vector<HyperParameter> Covariance::hyper_parameters() const {
  std::vector<HyperParameter> result;
  for (std::size_t t = 0; t < terms_.size(); ++t)
    for (HyperParameterRow const& one : terms_[t].row->hyper_parameters) {
      if (one.per_input)
        for (int const column : terms_[t].columns) result.push_back({one.name, static_cast<int>(t), column, one.unit});
      else
        result.push_back({one.name, static_cast<int>(t), -1, one.unit});
    }
  return result;
}

void Covariance::fill_lower(Eigen::MatrixXd const& inputs, Numbers parameters, Eigen::MatrixXd& out) const {
  Evaluation evaluation(*this, inputs, parameters);
  for (Eigen::Index j = 0; j < inputs.rows(); ++j)
    in_strips(j, inputs.rows(), [&](Eigen::Index first, int size) {
      double const* const values = evaluation.values(first, size, inputs, j);
      std::copy(values, values + size, &out(first, j));
    });
  for (Known const& each : known_)
    lapack::add_inner(-1, Conditions(*each.free, each.conditions, own(each, parameters)).whitened(inputs), out);
}

Eigen::MatrixXd Covariance::between(Eigen::MatrixXd const& inputs, Eigen::MatrixXd const& others, Numbers parameters) const {
  Eigen::MatrixXd out(inputs.rows(), others.rows());
  Evaluation evaluation(*this, inputs, parameters);
  for (Eigen::Index j = 0; j < others.rows(); ++j)
    in_strips(0, inputs.rows(), [&](Eigen::Index first, int size) {
      double const* const values = evaluation.values(first, size, others, j);
      std::copy(values, values + size, &out(first, j));
    });
  for (Known const& each : known_) {
    Conditions const conditions(*each.free, each.conditions, own(each, parameters));
    out -= lapack::inner(conditions.whitened(inputs), conditions.whitened(others));
  }
  return out;
}

Eigen::VectorXd Covariance::variances(Eigen::MatrixXd const& inputs, Numbers parameters) const {
  Eigen::VectorXd out(inputs.rows());
  Evaluation evaluation(*this, inputs, parameters);
  for (Eigen::Index i = 0; i < inputs.rows(); ++i) out[i] = evaluation.values(i, 1, inputs, i)[0];
  for (Known const& each : known_)
    out -= Conditions(*each.free, each.conditions, own(each, parameters)).whitened(inputs).colwise().squaredNorm().transpose();
  return out;
}

Eigen::VectorXd Covariance::gradient(Eigen::MatrixXd const& inputs, Numbers parameters, Eigen::MatrixXd const& lower_weight) const {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(parameter_count());
  Evaluation evaluation(*this, inputs, parameters);
  double weights[strip_size];
  for (Eigen::Index j = 0; j < inputs.rows(); ++j)
    in_strips(j, inputs.rows(), [&](Eigen::Index first, int size) {
      for (int i = 0; i < size; ++i) weights[i] = 2 * lower_weight(first + i, j);  // stands for both triangles
      if (first == j) weights[0] *= 0.5;
      evaluation.add_gradient(first, size, j, weights, gradient.data());
    });
  for (Known const& each : known_)
    gradient.segment(each.first_parameter, each.free->parameter_count()) -=
        Conditions(*each.free, each.conditions, own(each, parameters)).gradient(inputs, lower_weight);
  return gradient;
}

double Covariance::between(Condition const& left, Condition const& right, Numbers parameters, int parameter) const {
  unsigned part = 0;
  if (left.derivative >= 0) part |= Jet::left;
  if (right.derivative >= 0) part |= Jet::right;
  if (parameter >= 0) part |= Jet::parameter;
  std::vector<Jet> values, a, b, p;
  for (Node const& node : nodes_) {
    if (node.kind != Node::Kind::term) {
      Jet const &x = values[static_cast<std::size_t>(node.left)], &y = values[static_cast<std::size_t>(node.right)];
      values.push_back(node.kind == Node::Kind::sum ? x + y : x * y);
      continue;
    }
    Term const& term = terms_[static_cast<std::size_t>(node.left)];
    a.clear(), b.clear(), p.clear();
    for (int const c : term.columns) {
      a.emplace_back(left.point[static_cast<std::size_t>(c)], Jet::left, c == left.derivative ? 1 : 0);
      b.emplace_back(right.point[static_cast<std::size_t>(c)], Jet::right, c == right.derivative ? 1 : 0);
    }
    for (int j = term.first_parameter; j < term.first_parameter + term.parameter_count; ++j) {
      double const value = parameters[static_cast<std::size_t>(j)];
      p.emplace_back(value, Jet::parameter, j == parameter ? value : 0);
    }
    values.push_back(term.row->jet(a, b, p));
  }
  return values.back().part[part];
}

}  // namespace sysid::gaussian_process
