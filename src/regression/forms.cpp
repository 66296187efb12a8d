// The ways to have derivatives, one line each.
#include "core/setting/table.hpp"
#include "regression/column/columns.hpp"
#include "regression/column/difference.hpp"
#include "regression/column/sampled.hpp"
#include "regression/weak/weak.hpp"

namespace sysid::regression {
namespace {

std::string nothing_refused(Settings const&, int) { return {}; }

Form const form_rows[] = {
    {"weak",
     "integrals with test functions, which are differentiated in place of the data; the covariance of the residuals follows "
     "from the noise of the samples",
     weak::settings(), &weak::refuse, &weak::project},
    {"savitzky_golay", "local polynomials, inputs filtered in the same way", savitzky_golay::settings(), &savitzky_golay::refuse,
     &savitzky_golay::project},
    {"smoothing_spline", "a spline through each channel, inputs filtered in the same way", smoothing_spline::settings(),
     &nothing_refused, &smoothing_spline::project},
    {"central", "central differences, for records without noise", {}, &nothing_refused, &central::project},
    {"measured", "each derivative is measured in its own channel", {}, &nothing_refused, &measured::project},
};

Form const samples{"samples", "terms of earlier samples; the noise is a moving average", difference::settings(), &nothing_refused,
                   &difference::project};

}  // namespace

std::span<Form const> forms() { return form_rows; }

Form const& form_of_samples() { return samples; }

Form const* find_form(std::string_view name) { return name == samples.name ? &samples : row_named(form_rows, name); }

}  // namespace sysid::regression
