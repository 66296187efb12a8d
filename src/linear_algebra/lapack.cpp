// The library is loaded when a routine is first called, on one thread and with one set of kernels, so that results do not vary.
#include "linear_algebra/lapack.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "core/text/diagnostic.hpp"

namespace sysid::lapack {
namespace {

/// The library's routines, by Fortran's convention: everything by address, matrices by columns. Lengths of the strings, which
/// Fortran appends, are not read by routines that look at one character.
struct Routines {
  void (*factor)(char const* triangle, int const* n, double* a, int const* stride, int* info);
  void (*invert)(char const* triangle, int const* n, double* a, int const* stride, int* info);
  void (*solve)(char const* side, char const* triangle, char const* transposed, char const* diagonal, int const* m, int const* n,
                double const* factor, double const* a, int const* a_stride, double* b, int const* b_stride);
  void (*symmetric_update)(char const* triangle, char const* transposed, int const* n, int const* k, double const* factor,
                           double const* a, int const* a_stride, double const* keep, double* c, int const* c_stride);
  void (*multiply)(char const* a_transposed, char const* b_transposed, int const* m, int const* n, int const* k,
                   double const* factor, double const* a, int const* a_stride, double const* b, int const* b_stride,
                   double const* keep, double* c, int const* c_stride);
  char* (*kernels)();
};

[[noreturn]] void missing(char const* reason) {
  throw UserError({.code = "E0003",
                   .message = std::string("Gaussian processes need the library OpenBLAS, which cannot be loaded: ") + reason,
                   .primary = {},
                   .secondary = {},
                   .help = "install it: on Debian, `apt-get install libopenblas0-pthread`"});
}

template <class Function>
void find(void* library, char const* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  if (function == nullptr) missing(dlerror());
}

Routines load() {
  // Read once, while the library is loaded. Threads of its own would change the results with their number and would compete with
  // ours.
  setenv("OPENBLAS_NUM_THREADS", "1", 1);
#if defined(__aarch64__)
  setenv("OPENBLAS_CORETYPE", "ARMV8", 1);
#else
  setenv("OPENBLAS_CORETYPE", "Haswell", 1);
#endif
  void* const library = dlopen("libopenblas.so.0", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) missing(dlerror());
  Routines routines{};
  find(library, "dpotrf_", routines.factor);
  find(library, "dpotri_", routines.invert);
  find(library, "dtrsm_", routines.solve);
  find(library, "dsyrk_", routines.symmetric_update);
  find(library, "dgemm_", routines.multiply);
  find(library, "openblas_get_corename", routines.kernels);
  return routines;
}

Routines const& routines() {
  static Routines const loaded = load();
  return loaded;
}

int size(Eigen::Index n) { return static_cast<int>(n); }
int stride(Eigen::Ref<Eigen::MatrixXd const> const& matrix) {
  return static_cast<int>(std::max<Eigen::Index>(1, matrix.outerStride()));
}

void solve(char const* transposed, Eigen::Ref<Eigen::MatrixXd const> const& lower, Eigen::Ref<Eigen::MatrixXd>& right) {
  int const m = size(right.rows()), n = size(right.cols()), lower_stride = stride(lower), right_stride = stride(right);
  double const one = 1;
  if (m == 0 || n == 0) return;
  routines().solve("L", "L", transposed, "N", &m, &n, &one, lower.data(), &lower_stride, right.data(), &right_stride);
}

void update(char const* transposed, double factor, Eigen::Ref<Eigen::MatrixXd const> const& a, int k,
            Eigen::Ref<Eigen::MatrixXd>& c) {
  int const n = size(c.rows()), a_stride = stride(a), c_stride = stride(c);
  double const keep = 1;
  if (n == 0 || k == 0) return;
  routines().symmetric_update("L", transposed, &n, &k, &factor, a.data(), &a_stride, &keep, c.data(), &c_stride);
}

}  // namespace

bool cholesky(Eigen::Ref<Eigen::MatrixXd> symmetric) {
  int const n = size(symmetric.rows()), row_stride = stride(symmetric);
  int info = 0;
  if (n > 0) routines().factor("L", &n, symmetric.data(), &row_stride, &info);
  return info == 0;
}

void invert_cholesky(Eigen::Ref<Eigen::MatrixXd> lower) {
  int const n = size(lower.rows()), row_stride = stride(lower);
  int info = 0;
  if (n > 0) routines().invert("L", &n, lower.data(), &row_stride, &info);
}

void solve_lower(Eigen::Ref<Eigen::MatrixXd const> lower, Eigen::Ref<Eigen::MatrixXd> right) { solve("N", lower, right); }
void solve_lower_transposed(Eigen::Ref<Eigen::MatrixXd const> lower, Eigen::Ref<Eigen::MatrixXd> right) {
  solve("T", lower, right);
}

void add_outer(double factor, Eigen::Ref<Eigen::MatrixXd const> columns, Eigen::Ref<Eigen::MatrixXd> symmetric) {
  update("N", factor, columns, size(columns.cols()), symmetric);
}

void add_inner(double factor, Eigen::Ref<Eigen::MatrixXd const> rows, Eigen::Ref<Eigen::MatrixXd> symmetric) {
  update("T", factor, rows, size(rows.rows()), symmetric);
}

Eigen::MatrixXd inner(Eigen::Ref<Eigen::MatrixXd const> left, Eigen::Ref<Eigen::MatrixXd const> right) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(left.cols(), right.cols());
  int const m = size(left.cols()), n = size(right.cols()), k = size(left.rows());
  int const left_stride = stride(left), right_stride = stride(right);
  double const one = 1, zero = 0;
  if (m > 0 && n > 0 && k > 0)
    routines().multiply("T", "N", &m, &n, &k, &one, left.data(), &left_stride, right.data(), &right_stride, &zero, result.data(),
                        &m);
  return result;
}

char const* kernels() { return routines().kernels(); }

}  // namespace sysid::lapack
