// The sections of a task's page, in reading order.
#pragma once
#include <vector>

#include "report/page/html_elements.hpp"

namespace sysid {

/// `prefix` begins every id, so that several tasks can stand on one page; `level`: of the sections' headings. The verdict comes
/// first.
std::vector<HtmlSection> task_sections(Report const& report, std::vector<DrawnFigure> const& figures, std::string const& prefix,
                                       int level);

/// "good", "doubtful", "bad", or "plain" where nothing is judged.
std::string_view verdict_kind(Report const& report);

}  // namespace sysid
