// A covariance function as an expression: kernels on chosen inputs, their sums and products, and what is known of one beforehand.
#pragma once
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "gaussian_process/kernel.hpp"

namespace sysid::gaussian_process {

/// One hyper-parameter of an expression.
struct HyperParameter {
  std::string_view name;  // the kernel's word
  int term;               // which kernel of the expression, from the left
  int column;             // the input it belongs to, as a column of the inputs; -1: to none
  UnitPowers unit;        // of the output, of that input (the kernel's first where it belongs to none), and of the kernel's own
};

/// What is known of a function: its value at a point is 0, or its first derivative there in one input.
struct Condition {
  std::vector<double> point;  // by column of the inputs; what no kernel reads may be anything
  int derivative = -1;        // in which column; -1: the value
};

/// A value; copies are independent. Inputs are matrices [N x D], one row per point; a kernel reads the columns that it was given.
class Covariance {
 public:
  /// columns: which inputs the kernel reads, at least one unless it needs none; of `one_input`, exactly one.
  Covariance(KernelRow const& row, std::vector<int> columns);
  friend Covariance operator+(Covariance const& left, Covariance const& right);
  friend Covariance operator*(Covariance const& left, Covariance const& right);

  /// The process given that all conditions hold; what stands beside it in a sum is free of them. Products of such a covariance are
  /// not defined.
  ///
  ///   k_c(x, x') = k(x, x') - a(x)^T B^-1 a(x'),   a_i(x) = cov(f(x), c_i),   B = cov(c, c)     Rasmussen & Williams 2006,
  ///   eq. 2.19, sec. 9.4
  ///
  /// Conditions that the others imply (to 1e-10 of their variance) are left out of c. Kernels are differentiable where derivatives
  /// are known.
  Covariance conditioned(std::vector<Condition> conditions) const;

  struct Term {
    KernelRow const* row;
    std::vector<int> columns;
    int first_parameter;
    int parameter_count;
  };
  /// From the left, as written.
  std::vector<Term> const& terms() const { return terms_; }
  /// Whether it is a sum of single kernels and nothing is known of it.
  bool is_sum() const;
  int parameter_count() const;
  /// In the order of every vector of hyper-parameters here: term by term.
  std::vector<HyperParameter> hyper_parameters() const;

  /// Lower triangle of K [N x N] with K_ij = k(x_i, x_j); the upper is left as it is. All below take parameters > 0.
  void fill_lower(Eigen::MatrixXd const& inputs, Numbers parameters, Eigen::MatrixXd& out) const;
  /// k(x_i, z_j) [N x M].
  Eigen::MatrixXd between(Eigen::MatrixXd const& inputs, Eigen::MatrixXd const& others, Numbers parameters) const;
  /// k(x_i, x_i) [N].
  Eigen::VectorXd variances(Eigen::MatrixXd const& inputs, Numbers parameters) const;
  /// Sum over all i and j of weight_ij dk(x_i, x_j)/dlog(parameter), of a symmetric weight whose lower triangle is read;
  /// [parameters].
  Eigen::VectorXd gradient(Eigen::MatrixXd const& inputs, Numbers parameters, Eigen::MatrixXd const& lower_weight) const;
  /// cov(left, right) of values and derivatives without conditions, or its derivative in the logarithm of a parameter (-1: none).
  double between(Condition const& left, Condition const& right, Numbers parameters, int parameter = -1) const;

 private:
  /// Nodes stand behind their operands; the last one is the whole.
  struct Node {
    enum class Kind { term, sum, product } kind;
    int left, right;  // nodes; of a term, its number and nothing
  };
  Covariance() = default;
  struct Known;
  static Numbers own(Known const& known, Numbers parameters);
  static Covariance joined(Node::Kind kind, Covariance const& left, Covariance const& right);

  /// A part of a sum that conditions hold for.
  struct Known {
    std::shared_ptr<Covariance const> free;  // the part without them
    int first_parameter;
    std::vector<Condition> conditions;
  };

  std::vector<Term> terms_;
  std::vector<Node> nodes_;
  std::vector<Known> known_;

  friend class Evaluation;
};

}  // namespace sysid::gaussian_process
