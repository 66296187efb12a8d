/* A program in C that uses an installed libsysid: densities, gradients, a simulation, errors. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysid.h>

static void require(int holds, char const* what) {
  if (holds) return;
  fprintf(stderr, "not so: %s (%s)\n", what, sysid_error());
  exit(1);
}

static void refused(int failed, char const* message) { require(failed && strstr(sysid_error(), message) != NULL, message); }

/* What is NULL and must not be is an error. */
static void refused_null(sysid_model* model, double* theta, double* density) {
  double out[500];
  refused(sysid_load(NULL, NULL, 0) == NULL, "`path` is NULL");
  refused(sysid_load_text(NULL, "x.sysid", NULL, 0) == NULL, "`text` is NULL");
  refused(sysid_load_text("", NULL, NULL, 0) == NULL, "`path` is NULL");
  refused(sysid_log_density(model, 1, NULL, density), "`theta` is NULL");
  refused(sysid_log_density(model, 1, theta, NULL), "`density` is NULL");
  refused(sysid_log_density(NULL, 1, theta, density), "`model` is NULL");
  refused(sysid_log_density_gradient(model, 1, theta, density, NULL), "`gradient` is NULL");
  refused(sysid_constrain(model, 1, theta, NULL), "`values` is NULL");
  refused(sysid_unconstrain(model, 1, NULL, theta), "`values` is NULL");
  refused(sysid_sample_prior(model, 1, 1, NULL), "`theta` is NULL");
  refused(sysid_simulate(model, 0, NULL, 1, theta, out), "`quantity` is NULL");
  refused(sysid_time(model, 0, NULL), "`time` is NULL");
  refused(sysid_prepare(NULL, 1), "`model` is NULL");
  require(sysid_dimension(NULL) == 0 && sysid_name(NULL, 0) == NULL && sysid_experiments(NULL) == 0 && sysid_rows(NULL, 0) == 0,
          "no model has no parameters and no experiments");
  refused(sysid_load("nowhere.sysid", NULL, -1) == NULL, "`threads` is -1");
  refused(sysid_load("nowhere.sysid", NULL, 100000) == NULL, "`threads` is 100000");
}

int main(int argc, char** argv) {
  require(argc == 2, "the path of a file is given");
  sysid_model* model = sysid_load(argv[1], NULL, 0);
  require(model != NULL, "the file is loaded");
  require(strcmp(sysid_error(), "") == 0, "nothing went wrong");
  require(sysid_dimension(model) == 5, "there are five parameters");
  require(strcmp(sysid_name(model, 3), "k3") == 0 && strcmp(sysid_unit(model, 3), "N/m^3") == 0, "the fourth is k3");
  require(sysid_name(model, 5) == NULL, "there is no sixth");

  /* Two vectors: the true values, and others. */
  double const values[2][5] = {{1.0, 20.0, 1.0e4, 5.0e9, 8.0e10}, {1.1, 20.0, 1.0e4, 5.0e9, 8.0e10}};
  double theta[2][5], back[2][5], density[2], again[2], gradient[2][5];
  require(sysid_unconstrain(model, 2, &values[0][0], &theta[0][0]) == 0, "values have coordinates");
  require(sysid_constrain(model, 2, &theta[0][0], &back[0][0]) == 0, "and back");
  require(fabs(back[1][3] / values[1][3] - 1) < 1e-9, "they are the same");
  require(sysid_log_density(model, 2, &theta[0][0], density) == 0, "there is a density");
  require(density[0] - density[1] > 1000, "the true values are better");
  require(sysid_log_density_gradient(model, 2, &theta[0][0], again, &gradient[0][0]) == 0, "there is a gradient");
  require(fabs(again[0] - density[0]) < 1e-8, "of the same density");
  double const step = 1e-6;
  double moved[5], ahead, behind;
  memcpy(moved, theta[1], sizeof moved);
  moved[0] += step;
  sysid_log_density(model, 1, moved, &ahead);
  moved[0] -= 2 * step;
  sysid_log_density(model, 1, moved, &behind);
  require(fabs((ahead - behind) / (2 * step) / gradient[1][0] - 1) < 1e-4, "the gradient is the slope");
  require(sysid_log_density(model, 0, NULL, NULL) == 0, "no vectors are no work");

  double const nowhere[5] = {NAN, 0, 0, 0, 0};
  double slope[5] = {0};
  require(sysid_log_density_gradient(model, 1, nowhere, again, slope) == 0 && isinf(again[0]) && isnan(slope[0]) && isnan(slope[4]),
          "where there is no density there is no gradient");

  require(sysid_experiments(model) == 1 && sysid_rows(model, 0) == 500 && sysid_rows(model, 1) == 0, "one experiment of 500 rows");
  double* time = malloc(500 * sizeof(double));
  double* made = malloc(2 * 500 * sizeof(double));
  require(sysid_time(model, 0, time) == 0 && fabs(time[499] - 0.499) < 1e-12, "rows have times");
  require(sysid_simulate(model, 0, "displacement", 2, &values[0][0], made) == 0, "the model is simulated");
  require(made[499] != made[999] && fabs(made[499]) < 1e-2 && made[499] != 0, "along the rows, for each vector");
  require(sysid_simulate(model, 0, "velocity", 1, &values[0][0], made) == 1, "what is not there cannot be simulated");
  require(strstr(sysid_error(), "there is no quantity `velocity`") != NULL, "and the error names it");
  require(sysid_simulate(model, 1, "y", 1, &values[0][0], made) == 1, "neither can another experiment");
  free(made);
  free(time);

  double drawn[2][5];
  require(sysid_sample_prior(model, 2, 1, &drawn[0][0]) == 0 && drawn[0][0] != drawn[1][0], "the prior is drawn");
  require(sysid_prepare(model, 1) == 0, "the modes are found");
  refused_null(model, &theta[0][0], density);
  sysid_free(model);
  sysid_free(NULL);

  require(sysid_load("nowhere.sysid", NULL, 0) == NULL, "a file that is not there");
  require(strstr(sysid_error(), "cannot read `nowhere.sysid`") != NULL, "is not loaded");
  require(sysid_load(argv[1], "forecast", 0) == NULL, "a task that is no fit");
  require(strstr(sysid_error(), "`forecast` is not a fit task") != NULL, "has no density");
  require(sysid_load_text("model m {\n  state y [m\n}\n", "cell.sysid", NULL, 0) == NULL, "a text with a mistake");
  require(strstr(sysid_error(), "cell.sysid:") != NULL && strstr(sysid_error(), "error[E1") != NULL, "is refused where it stands");
  printf("%.17g %.17g %s\n", density[0], density[1], sysid_version());
  return 0;
}
