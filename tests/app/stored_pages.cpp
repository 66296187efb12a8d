// Pages written by a run against pages made from its folder.
#include "app/stored_pages.hpp"

#include "app/run/report_results.hpp"
#include "core/system/files.hpp"
#include "experiment/prior_density.hpp"
#include "page_rules.hpp"
#include "report/figure/figures.hpp"
#include "report/file/stored_report.hpp"
#include "temporary_folder.hpp"

namespace sysid::test {

namespace fs = std::filesystem;

std::string broken_promises(fs::path const& run) {
  std::string broken;
  TemporaryFolder const folder;
  auto const check = [&](fs::path const& results) {
    std::string page = read_file(report_results(results, folder.path() / "page.html", false));
    if (std::string const rules = broken_rules(page); !rules.empty()) broken += results.string() + ": " + rules;
    return page;
  };
  bool any = false;
  for (fs::directory_entry const& entry : fs::directory_iterator(run)) {
    fs::path const& task = entry.path();
    if (!fs::exists(task / "summary.json")) continue;
    any = true;
    if (check(task) != read_file(task / "report.html")) broken += task.string() + ": the page comes back otherwise\n";
    Report report = read_result(task);
    for (PriorInfo& prior : report.priors) add_density(prior);
    for (plot::Figure const& figure : figures(report)) {
      fs::path const script = task / "figures" / (figure.name + ".gnuplot");
      if (!fs::exists(script) || read_file(script) != figure.script)
        broken += task.string() + ": the figure " + figure.name + " comes back otherwise\n";
    }
  }
  if (any) (void)check(run);
  return broken;
}

}  // namespace sysid::test
