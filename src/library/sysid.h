/* sysid in programs of C and of languages that call C: the posterior density of a fit as a function. docs/library.md.
 *
 * Parameter vectors are rows: of arrays double[count][dimension], one vector behind the other. `theta` are unconstrained
 * coordinates, any numbers; `values` are in the units that the file declares. Functions that return int return 0, or 1 where
 * something went wrong, which sysid_error describes, be it NULL for an argument that is needed. A model may be used by several
 * threads at once, sysid_prepare and sysid_free excepted. Names and numbers of this header are kept from version to version. */
#ifndef SYSID_H
#define SYSID_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SYSID_API __attribute__((visibility("default")))

typedef struct sysid_model sysid_model;

/* "0.1.0" */
SYSID_API const char* sysid_version(void);

/* Opens a file of the language and reads the data of one of its fits. task: the name of the fit; NULL: the first. threads: 0: one
 * for each processor; at most 4096. NULL where it fails. */
SYSID_API sysid_model* sysid_load(const char* path, const char* task, int threads);
/* The same of a text; path: the file that it would be, from whose folder paths of data and modules are relative. */
SYSID_API sysid_model* sysid_load_text(const char* text, const char* path, const char* task, int threads);
/* NULL is nothing to free. */
SYSID_API void sysid_free(sysid_model* model);

/* What went wrong last in this thread, the message that the command line prints; "" where nothing did. It lives until the next
 * call. */
SYSID_API const char* sysid_error(void);

/* The sampled parameters, in the order of the columns of arrays. Texts live as long as the model. */
SYSID_API size_t sysid_dimension(const sysid_model* model);
SYSID_API const char* sysid_name(const sysid_model* model, size_t parameter);
SYSID_API const char* sysid_unit(const sysid_model* model, size_t parameter);

/* What `sysid fit` does before its first sample: finds the modes and the solver, which the density has from here on. */
SYSID_API int sysid_prepare(sysid_model* model, uint64_t seed);

/* values[count][dimension] of theta[count][dimension], and back. */
SYSID_API int sysid_constrain(const sysid_model* model, size_t count, const double* theta, double* values);
SYSID_API int sysid_unconstrain(const sysid_model* model, size_t count, const double* values, double* theta);
/* Draws of the prior: theta[count][dimension]. */
SYSID_API int sysid_sample_prior(const sysid_model* model, size_t count, uint64_t seed, double* theta);

/* log prior + log likelihood of theta[count][dimension], the Jacobian of sysid_constrain included: density[count]. -infinity where a
 * simulation fails. */
SYSID_API int sysid_log_density(const sysid_model* model, size_t count, const double* theta, double* density);
/* The same, and its derivatives by theta: gradient[count][dimension], NaN where the density is -inf. */
SYSID_API int sysid_log_density_gradient(const sysid_model* model, size_t count, const double* theta, double* density,
                                         double* gradient);

/* The experiments of the fit, and what can be simulated along their rows: channels, states, derived quantities. */
SYSID_API size_t sysid_experiments(const sysid_model* model);
SYSID_API size_t sysid_rows(const sysid_model* model, size_t experiment);
/* time[rows], in seconds. */
SYSID_API int sysid_time(const sysid_model* model, size_t experiment, double* time);
/* A quantity along an experiment for values[count][dimension], in its declared unit and without noise: out[count][rows]. NaN where
 * a simulation fails. */
SYSID_API int sysid_simulate(const sysid_model* model, size_t experiment, const char* quantity, size_t count, const double* values,
                             double* out);

#ifdef __cplusplus
}
#endif
#endif
