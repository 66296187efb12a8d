// One row for each form.
#include "discovery/search/outside_functions.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/numeric/elementary.hpp"
#include "discovery/structure_prior.hpp"

namespace sysid {
namespace {

constexpr double factor = simplicity_of_factor, function = simplicity_of_function;
constexpr double same = 1e-9;    // squared sine of the angle between two columns
constexpr double largest = 1e8;  // of its root mean square: no pole between the samples

struct OfOne {
  char const* text;
  double simplicity;
  double (*value)(double);
};

constexpr OfOne powers[] = {
    {"1", 1, [](double) { return 1.0; }},
    {"{0}", 1, [](double a) { return a; }},
    {"{0}^2", factor, [](double a) { return a * a; }},
    {"{0}^3", factor* factor, [](double a) { return a * a * a; }},
    {"{0}^4", factor* factor* factor, [](double a) { return a * a * a * a; }},
    {"{0}^5", factor* factor* factor* factor, [](double a) { return a * a * a * a * a; }},
    {"abs({0})*{0}", factor* factor, [](double a) { return std::abs(a) * a; }},
    {"sign({0})", factor, [](double a) { return static_cast<double>((a > 0) - (a < 0)); }},
    {"sqrt({0})", function, [](double a) { return std::sqrt(a); }},
    {"1/{0}", function, [](double a) { return 1 / a; }},
};

constexpr OfOne functions[] = {
    {"sin({0})", function, [](double a) { return elementary::sin(a); }},
    {"cos({0})", function, [](double a) { return elementary::cos(a); }},
    {"sin(2*{0})", function, [](double a) { return elementary::sin(2 * a); }},
    {"exp({0})", function, [](double a) { return elementary::exp(a); }},
    {"exp(-{0})", function, [](double a) { return elementary::exp(-a); }},
    {"exp(-2*{0})", function, [](double a) { return elementary::exp(-2 * a); }},
    {"log({0})", function, [](double a) { return a > 0 ? elementary::log(a) : std::nan(""); }},
    {"{0}*log({0})", function* factor, [](double a) { return a > 0 ? a * elementary::log(a) : std::nan(""); }},
    {"{0}/(1 + {0})", function, [](double a) { return a > -1 ? a / (1 + a) : std::nan(""); }},
    {"{0}^2/(1 + {0}^2)", function* factor* factor, [](double a) { return a * a / (1 + a * a); }},
    {"tanh({0})", function, [](double a) { return elementary::tanh(a); }},
};

constexpr OfOne times_another[] = {
    {"{1}*sin({0})", function* factor, [](double a) { return elementary::sin(a); }},
    {"{1}*cos({0})", function* factor, [](double a) { return elementary::cos(a); }},
    {"{1}*exp({0})", function* factor, [](double a) { return elementary::exp(a); }},
    {"{1}*exp(-{0})", function* factor, [](double a) { return elementary::exp(-a); }},
    {"{1}*{0}/(1 + {0})", function* factor, [](double a) { return a > -1 ? a / (1 + a) : std::nan(""); }},
};

constexpr OfOne products[] = {
    {"{0}^2*{1}", factor* factor, [](double a) { return a * a; }},
    {"{0}^3*{1}", factor* factor* factor, [](double a) { return a * a * a; }},
    {"{0}^4*{1}", factor* factor* factor* factor, [](double a) { return a * a * a * a; }},
    {"abs({0})*{1}", factor* factor, [](double a) { return std::abs(a); }},
};

class Collector {
 public:
  explicit Collector(Eigen::MatrixXd const& known) {
    for (Eigen::Index j = 0; j < known.cols(); ++j) add_known(known.col(j));
  }

  void offer(std::string text, double simplicity, Eigen::VectorXd values) {
    double const size = values.norm() / std::sqrt(static_cast<double>(values.size()));
    if (!values.allFinite() || !(size > 0) || values.lpNorm<Eigen::Infinity>() > largest * size) return;
    Eigen::VectorXd const unit = values / values.norm();
    for (Eigen::VectorXd const& each : known_) {
      double const along = each.dot(unit);
      if ((unit - along * each).squaredNorm() < same) return;
    }
    known_.push_back(unit);
    found_.push_back({std::move(text), simplicity, std::move(values)});
  }
  std::vector<OutsideFunction> found() { return std::move(found_); }

 private:
  void add_known(Eigen::VectorXd const& values) {
    double const length = values.norm();
    if (std::isfinite(length) && length > 0) known_.push_back(values / length);
  }
  std::vector<Eigen::VectorXd> known_;
  std::vector<OutsideFunction> found_;
};

}  // namespace

std::vector<OutsideFunction> outside_functions(StateValues const& states, Eigen::MatrixXd const& known) {
  Collector all(known);
  auto const column = [&](std::size_t x) { return states.values.col(static_cast<Eigen::Index>(x)); };
  auto const text = [&](OfOne const& of, std::size_t a, std::size_t b) {
    return fmt::format(fmt::runtime(of.text), states.names[a], states.names[b]);
  };
  for (std::size_t a = 0; a < states.names.size(); ++a) {
    for (OfOne const& of : powers) all.offer(text(of, a, a), of.simplicity, column(a).unaryExpr(of.value));
    for (OfOne const& of : functions)
      if (states.plain[a] != 0) all.offer(text(of, a, a), of.simplicity, column(a).unaryExpr(of.value));
  }
  for (std::size_t a = 0; a < states.names.size(); ++a)
    for (std::size_t b = 0; b < states.names.size(); ++b) {
      if (a == b) continue;
      if (a < b) {
        all.offer(states.names[a] + "*" + states.names[b], factor, column(a).cwiseProduct(column(b)));
        all.offer(fmt::format("{}^2*{}^2", states.names[a], states.names[b]), factor * factor * factor,
                  column(a).cwiseProduct(column(b)).cwiseAbs2());
      }
      for (OfOne const& of : products)
        all.offer(text(of, a, b), of.simplicity, column(a).unaryExpr(of.value).cwiseProduct(column(b)));
      for (OfOne const& of : times_another)
        if (states.plain[a] != 0) all.offer(text(of, a, b), of.simplicity, column(a).unaryExpr(of.value).cwiseProduct(column(b)));
    }
  return all.found();
}

}  // namespace sysid
