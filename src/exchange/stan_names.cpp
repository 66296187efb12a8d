// Reserved words of Stan by the place where they have a meaning, in the order of the manual.
#include "exchange/stan_names.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <sstream>
#include <string_view>

namespace sysid {
namespace {

constexpr char const* statements = R"(
for in while repeat until if then else true false break continue return target jacobian struct typedef export auto extern var static
lower upper offset multiplier print reject profile fatal_error get_lp increment_log_prob STAN_MAJOR STAN_MINOR STAN_PATCH
STAN_MATH_MAJOR STAN_MATH_MINOR STAN_MATH_PATCH functions model data parameters quantities transformed generated)";

constexpr char const* types = R"(
void int real complex vector row_vector matrix complex_vector complex_row_vector complex_matrix array tuple simplex unit_vector
sum_to_zero_vector sum_to_zero_matrix ordered positive_ordered cholesky_factor_corr cholesky_factor_cov corr_matrix cov_matrix
column_stochastic_matrix row_stochastic_matrix)";

constexpr char const* words_of_cpp = R"(
alignas alignof and and_eq asm bitand bitor bool case catch char char16_t char32_t class compl const constexpr const_cast decltype
default delete do double dynamic_cast enum explicit float friend fvar goto inline long mutable namespace new noexcept not not_eq
nullptr operator or or_eq private protected public register reinterpret_cast short signed sizeof static_assert static_cast switch
template this thread_local throw try typeid typename union unsigned using virtual volatile wchar_t xor xor_eq)";

constexpr char const* library = R"(
abs acos acosh add add_diag algebra_solver algebra_solver_newton append_array append_col append_row asin asinh atan atan2
atanh bessel_first_kind bessel_second_kind binary_log_loss block cbrt ceil cholesky_decompose choose col cols
columns_dot_product columns_dot_self cos cosh cov_exp_quad crossprod csr_extract_u csr_extract_v csr_extract_w
csr_matrix_times_vector csr_to_dense_matrix cumulative_sum determinant diag_matrix diag_post_multiply diag_pre_multiply
diagonal digamma dims distance divide dot_product dot_self e eigenvalues_sym eigenvectors_sym elt_divide elt_multiply erf erfc
exp exp2 expm1 fabs falling_factorial fdim floor fma fmax fmin fmod gamma_p gamma_q gp_dot_prod_cov gp_exp_quad_cov
gp_exponential_cov gp_matern32_cov gp_matern52_cov gp_periodic_cov head hypot if_else inc_beta int_step integrate_1d
integrate_ode integrate_ode_adams integrate_ode_bdf integrate_ode_rk45 inv inv_cloglog inv_logit inv_Phi inv_sqrt inv_square
inverse inverse_spd is_inf is_nan lbeta lchoose lgamma lmgamma lmultiply log log10 log1m log1m_exp log1m_inv_logit log1p
log1p_exp log2 log_determinant log_diff_exp log_falling_factorial log_inv_logit log_mix log_rising_factorial log_softmax
log_sum_exp logical_and logical_eq logical_gt logical_gte logical_lt logical_lte logical_negation logical_neq logical_or logit
machine_precision map_rect matrix_exp matrix_exp_multiply max mdivide_left mdivide_left_spd mdivide_left_tri_low mdivide_right
mdivide_right_spd mdivide_right_tri_low mean min minus modified_bessel_first_kind modified_bessel_second_kind modulus multiply
multiply_lower_tri_self_transpose negative_infinity not_a_number num_elements owens_t Phi Phi_approx pi positive_infinity pow
prod qr_Q qr_R qr_thin_Q qr_thin_R quad_form quad_form_diag quad_form_sym rank rep_array rep_matrix rep_row_vector rep_vector
rising_factorial round row rows rows_dot_product rows_dot_self scale_matrix_exp_multiply sd segment sin singular_values sinh
size softmax sort_asc sort_desc sort_indices_asc sort_indices_desc sqrt sqrt2 square squared_distance step sub_col sub_row
subtract sum tail tan tanh target tcrossprod tgamma to_array_1d to_array_2d to_matrix to_row_vector to_vector trace
trace_gen_quad_form trace_quad_form transpose trigamma trunc variance
arg chol2inv conj generalized_inverse get_imag get_real hmm_marginal identity_matrix lambert_w0 lambert_wm1 ldexp linspaced_vector
log_inv_logit_diff norm norm1 norm2 one_hot_vector ones_vector polar proj quantile reduce_sum reverse svd_U svd_V to_complex
to_int uniform_simplex zeros_vector)";

constexpr std::array distribution_endings = {"_lpdf", "_lpmf", "_lupdf", "_lupmf", "_lcdf", "_lccdf",
                                             "_cdf",  "_ccdf", "_rng",   "_log",   "_lp",   "_jacobian"};

std::set<std::string> const& reserved() {
  static std::set<std::string> const all = [] {
    std::set<std::string> words;
    for (char const* list : {statements, types, words_of_cpp, library}) {
      std::istringstream in(list);
      for (std::string word; in >> word;) words.insert(word);
    }
    return words;
  }();
  return all;
}

bool meant_by_stan(std::string const& name) {
  return reserved().contains(name) || std::any_of(distribution_endings.begin(), distribution_endings.end(),
                                                  [&](char const* ending) { return name.ends_with(ending); });
}

/// Letters, digits and single underscores between them, a letter first.
std::string spelt(std::string const& name) {
  std::string identifier;
  for (char const c : name) {
    bool const letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (letter || (!identifier.empty() && identifier.back() != '_')) identifier += letter ? c : '_';
  }
  while (identifier.ends_with('_')) identifier.pop_back();
  bool const begins = !identifier.empty() && (identifier.front() < '0' || identifier.front() > '9');
  return begins ? identifier : "parameter_" + identifier;
}

}  // namespace

std::string stan_identifier(std::string const& name, std::vector<std::string>& taken) {
  std::string const identifier = spelt(name);
  std::string free = identifier;
  for (int k = 1; meant_by_stan(free) || std::find(taken.begin(), taken.end(), free) != taken.end(); ++k)
    free = identifier + "_" + std::to_string(k);
  taken.push_back(free);
  return free;
}

}  // namespace sysid
