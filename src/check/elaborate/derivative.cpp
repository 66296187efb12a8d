// Differentiation on the syntax tree; zeros and ones are left out as soon as they arise.
#include "check/elaborate/derivative.hpp"

#include <algorithm>

#include "check/elaborate/tree.hpp"

namespace sysid {
namespace {

using Expression = ast::Expression;

// Definitions inside of definitions and operators inside of operators; below 1 kB of stack each.
constexpr int deepest_rate = 4500;

class Rate {
 public:
  Rate(std::function<std::optional<OverTime>(std::string const&)> const& motion_of, std::size_t& left)
      : motion_of_(motion_of), left_(left) {}

  std::optional<Expression> of(Expression const& expression) {
    if (left_ == 0 || depth_ == deepest_rate) {
      left_ = 0;
      return std::nullopt;
    }
    --left_;
    ++depth_;
    auto rate = derivative(expression);
    --depth_;
    return rate;
  }

 private:
  std::optional<Expression> derivative(Expression const& expression);

  std::function<std::optional<OverTime>(std::string const&)> const& motion_of_;
  std::size_t& left_;
  int depth_ = 0;
};

std::optional<Expression> Rate::derivative(Expression const& expression) {
  Span const span = expression.span;
  if (std::holds_alternative<ast::Number>(expression.node)) return tree::number(0, span);
  if (auto const* reference = std::get_if<ast::Reference>(&expression.node)) {
    auto const motion = motion_of_(reference->name.text);
    if (!motion) return std::nullopt;
    switch (motion->kind) {
      case OverTime::Kind::moving:
        return tree::reference(reference->name.text, reference->primes + 1, span);
      case OverTime::Kind::still:
        return tree::number(0, span);
      case OverTime::Kind::time:
        return tree::number(1, span);
      case OverTime::Kind::defined:
        return reference->primes == 0 ? of(*motion->definition) : std::nullopt;
    }
  }
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&expression.node)) {
    if ((*unary)->symbol != "-") return std::nullopt;
    auto operand = of(*(*unary)->operand);
    if (!operand || tree::is_number(*operand, 0)) return operand;
    return tree::unary("-", std::move(*operand), span);
  }
  auto const* binary = std::get_if<ast::Box<ast::Binary>>(&expression.node);
  if (binary == nullptr) return std::nullopt;
  std::string const& symbol = (*binary)->symbol;
  Expression const &left = *(*binary)->left, &right = *(*binary)->right;
  auto a = of(left), b = of(right);
  if (!a || !b) return std::nullopt;
  if (symbol == "+") return tree::sum(std::move(*a), std::move(*b), span);
  if (symbol == "-") return tree::difference(std::move(*a), std::move(*b), span);
  // The rules below copy both sides.
  left_ -= std::min(left_, tree::size(left, left_) + tree::size(right, left_));
  if (left_ == 0) return std::nullopt;
  if (symbol == "*") return tree::sum(tree::product(std::move(*a), right, span), tree::product(left, std::move(*b), span), span);
  if (symbol == "/") {
    Expression first = tree::is_number(*a, 0) ? tree::number(0, span) : tree::binary("/", std::move(*a), right, span);
    Expression second = tree::is_number(*b, 0) ? tree::number(0, span)
                                               : tree::binary("/", tree::product(left, std::move(*b), span),
                                                              tree::binary("^", right, tree::number(2, span), span), span);
    return tree::difference(std::move(first), std::move(second), span);
  }
  if (symbol == "^" && tree::is_number(*b, 0)) {
    if (tree::is_number(*a, 0)) return a;
    Expression power = tree::binary("^", left, tree::binary("-", right, tree::number(1, span), span), span);
    return tree::product(tree::binary("*", right, std::move(power), span), std::move(*a), span);
  }
  return std::nullopt;
}

}  // namespace

std::optional<Expression> time_derivative(Expression const& expression,
                                          std::function<std::optional<OverTime>(std::string const&)> const& motion_of,
                                          std::size_t& left) {
  return Rate(motion_of, left).of(expression);
}

}  // namespace sysid
