// A covariance function as an expression: kernels on chosen inputs, their sums and products.
#pragma once
#include <Eigen/Core>
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

/// A value; copies are independent. Inputs are matrices [N x D], one row per point; a kernel reads the columns that it was given.
class Covariance {
 public:
  /// columns: which inputs the kernel reads, at least one unless it needs none; of `one_input`, exactly one.
  Covariance(KernelRow const& row, std::vector<int> columns);
  friend Covariance operator+(Covariance const& left, Covariance const& right);
  friend Covariance operator*(Covariance const& left, Covariance const& right);

  struct Term {
    KernelRow const* row;
    std::vector<int> columns;
    int first_parameter;
    int parameter_count;
  };
  /// From the left, as written.
  std::vector<Term> const& terms() const { return terms_; }
  /// Whether it is a sum of single kernels.
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

 private:
  /// Nodes stand behind their operands; the last one is the whole.
  struct Node {
    enum class Kind { term, sum, product } kind;
    int left, right;  // nodes; of a term, its number and nothing
  };
  Covariance() = default;
  static Covariance joined(Node::Kind kind, Covariance const& left, Covariance const& right);

  std::vector<Term> terms_;
  std::vector<Node> nodes_;

  friend class Evaluation;
};

}  // namespace sysid::gaussian_process
