// The bodies of a page's sections, by subject; report/page/html_sections puts them in order. Empty where there is no content.
#pragma once
#include <string>
#include <vector>

#include "report/page/html_elements.hpp"

namespace sysid {

// What was found: report/page/html_result.

/// Parameters from prior to posterior, the evidence, and the tables of this kind of task.
std::string result_html(Report const& report);
std::string modes_html(Report const& report);

/// Names stay as they are written; words begin with a capital.
enum class TitleBegins { with_a_word, with_a_name };
/// words: how many of the first columns are words and not numbers.
std::string table_html(ReportTable const& table, std::size_t words = 1, TitleBegins title = TitleBegins::with_a_word);

// How well it fits: report/page/html_scores.

/// Of one channel with what each score says; of several as a table, and what the worst of each score says behind it.
std::string scores_html(Report const& report);

// How well it would predict: report/page/html_criteria.

/// Information criteria and predictive scores, with what says how far they can be trusted.
std::string criteria_html(Report const& report);

// Whether the computation can be believed: report/page/html_computation.

std::string chains_html(Report const& report);
/// How many simulations there were, and each kind of failure with its place.
std::string simulations_html(Report const& report);

// Where it comes from: report/page/html_provenance.

/// The records, each under a heading of this level.
std::string data_html(Report const& report, int level);
std::string settings_html(Report const& report);
/// The command and the file that make the result again.
std::string repetition_html(Report const& report);

}  // namespace sysid
