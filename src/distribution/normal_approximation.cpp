// One row for each noise.
#include "distribution/normal_approximation.hpp"

#include "core/setting/table.hpp"
#include "core/text/diagnostic.hpp"
#include "distribution/rows.hpp"

namespace sysid {
namespace {

constexpr double least_variance_of_counts = 0.25;

struct Normal {
  Term mean, sd;
};

Normal of_student_t(Graph& graph, Nodes a) {
  Term const n(graph, a[1]);
  Term const least = n / (2.0 * n + 4.0), beyond = max(n - 2.0, least);
  return {Term(graph, a[0]), Term(graph, a[2]) * sqrt(n / beyond)};
}

Normal of_log_normal(Graph& graph, Nodes a) {
  Term const median(graph, a[0]), s(graph, a[1]);
  Term const square = s * s, growth = exp(square);
  Term const beyond = expm1(square);  // 1 of exp hides a small sd
  return {median * sqrt(growth), median * sqrt(growth * beyond)};
}

Normal of_counts(Graph& graph, Term mean, Term variance) {
  return {mean, sqrt(Term(graph, graph.binary(Operation::maximum, variance.id, graph.constant(least_variance_of_counts))))};
}
Normal of_poisson(Graph& graph, Nodes a) { return of_counts(graph, Term(graph, a[0]), Term(graph, a[0])); }
Normal of_negative_binomial(Graph& graph, Nodes a) {
  Term const mean(graph, a[0]), shape(graph, a[1]);
  return of_counts(graph, mean, mean + mean * mean / shape);
}

struct Row {
  std::string_view name;
  Normal (*approximation)(Graph&, Nodes);
};
constexpr Row rows[] = {{"student_t", &of_student_t},
                        {"log_normal", &of_log_normal},
                        {"poisson", &of_poisson},
                        {"negative_binomial", &of_negative_binomial}};

}  // namespace

Distribution normal_approximation(Graph& graph, Distribution const& noise) {
  if (noise.row->gaussian) return noise;
  Row const* const row = row_named(rows, noise.row->name);
  if (row == nullptr) throw InternalError("a noise without a normal approximation");
  auto const [mean, sd] = row->approximation(graph, noise.arguments);
  Distribution normal;
  normal.row = find_distribution("normal");
  normal.arguments = {mean.id, sd.id};
  return normal;
}

}  // namespace sysid
