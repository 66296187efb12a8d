// One row for each verb that leaves a page; that of `fit` stands for any other.
#include "report/page/verb_words.hpp"

#include "core/setting/table.hpp"

namespace sysid {
namespace {

constexpr std::string_view rejected_words = "Parameters whose simulation fails are rejected";
constexpr std::string_view left_out_words = "Trajectories that fail are left out of the bands";
constexpr std::string_view words_of_fits =
    "No check failed. This does not prove the model: compare it with measurements, preferably on rows that were not used in the "
    "fit.";
constexpr std::string_view moving_numbers = "the numbers below may change by more than their stated uncertainty";
constexpr std::string_view moving_bands = "the bands below may change by more than their stated uncertainty";

constexpr VerbWords verb_rows[] = {
    {"fit", "the numbers", moving_numbers, words_of_fits, rejected_words, "draws"},
    {"select", "the numbers", moving_numbers, words_of_fits, rejected_words, "draws"},
    {"discover", "the equations", "the equations below may change by more than their stated uncertainty",
     "No check failed. The equations are the best from the terms of the dictionary; this does not prove that no other term acts.",
     rejected_words, "equations"},
    {"predict", "the bands", moving_bands,
     "No check failed. The bands are valid if the model is valid on this record: compare them with the measurement.",
     left_out_words, "draws"},
    {"track", "the bands", moving_bands,
     "The model follows the rows, and no change was found. There may still be one: a slow change may be taken for drift, and a "
     "change of the noise is not reported as a change.",
     left_out_words, "table"},
    {"crosscheck", "either of these fits", "do not rely on the draws of either back end",
     "The back ends agree, as far as this comparison can show: sampling is no reason to doubt this fit. This does not prove the "
     "model: compare it with measurements.",
     rejected_words, "result"},
    {"calibrate", "intervals of such fits", "do not rely on intervals of such fits", "", rejected_words, "result"},
};

}  // namespace

VerbWords const& verb_words(Report const& report) {
  VerbWords const* const row = row_named(verb_rows, report.verb);
  return row == nullptr ? verb_rows[0] : *row;
}

}  // namespace sysid
