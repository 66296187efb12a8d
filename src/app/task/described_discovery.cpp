// Equation by equation, term by term.
#include "app/task/described_discovery.hpp"

#include <fmt/format.h>

#include "discovery/coefficient_names.hpp"
#include "discovery/excluded_terms.hpp"
#include "discovery/found_equation.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

class InWords {
 public:
  explicit InWords(DiscoveryInWords const& of) : of_(of) {}

  DiscoveryReport report(regression::Discovery const& found, regression::SelectorRow const& selector) const {
    DiscoveryReport out;
    out.selector = of_.what.selector;
    out.derivatives = of_.what.form;
    out.measure = selector.measure;
    out.windows = found.half_width > 0;
    out.half_width = found.half_width;
    for (std::size_t c = 0; c < found.noise_sd.size(); ++c) {
      Channel const& channel = of_.dictionary.measured.channels[c];
      out.noise.push_back({channel.name, channel.unit_text(), channel.from_si(found.noise_sd[c]), given(c)});
    }
    for (std::size_t k = 0; k < of_.inner.size(); ++k) {
      Quantity const& each = of_.dictionary.inner[k].quantity;
      out.inner.push_back({each.name, each.unit_text(), prior_text(each.name), each.from_si(of_.inner[k]), {}});
      if (!of_.inner_sd.empty()) out.inner.back().sd = of_.inner_sd[k] / (each.unit ? each.unit->scale : 1);
    }
    for (ExcludedText& each : excluded_texts(of_.dictionary))
      out.excluded.push_back({std::move(each.term), std::move(each.reason)});
    for (std::size_t e = 0; e < found.equations.size(); ++e)
      out.equations.push_back(described(found.equations[e], static_cast<int>(e)));
    return out;
  }

 private:
  bool given(std::size_t channel) const { return !of_.what.noise.empty() && of_.what.noise[channel]; }

  DiscoveredEquation described(regression::FoundEquation const& found, int index) const {
    DictionaryEquation const& equation = of_.dictionary.equations[static_cast<std::size_t>(index)];
    std::vector<std::string> const names = coefficient_names(of_.dictionary, index);
    DiscoveredEquation out;
    out.target = equation.text;
    if (!found.found) return out;
    out.explained = found.explained;
    out.noise_ratio = found.noise_ratio;
    out.unit = equation.unit ? equation.unit->text : "";
    out.moving_average = found.moving_average;
    out.own_noise = found.own_noise / (equation.unit ? equation.unit->scale : 1);
    out.rows = found.rows;
    out.exact = found.exact;
    out.converged = found.converged;
    for (std::size_t j = 0; j < found.terms.size(); ++j) {
      regression::FoundTerm const& from = found.terms[j];
      DictionaryTerm const& term = equation.terms[j];
      double const scale = term.unit ? term.unit->scale : 1;
      DiscoveredTerm to;
      to.text = term.in_target ? fmt::format("{}, in the target", term.text) : term.text;
      to.name = names[j];
      to.unit = term.unit ? term.unit->text : "";
      to.kept = from.kept;
      to.fate = from.excluded    ? TermFate{TermFate::Kind::left_out}
                : term.in_target ? TermFate{TermFate::Kind::known}
                : from.kept      ? TermFate{TermFate::Kind::kept}
                                 : TermFate{TermFate::Kind::dropped, from.dropped_in};
      to.coefficient = from.coefficient / scale;
      to.sd = from.sd / scale;
      to.measure = from.measure;
      to.measure_error = from.measure_error;
      to.mean = from.mean / scale;
      to.mean_sd = from.mean_sd / scale;
      to.contribution = from.contribution;
      to.inflation = from.inflation;
      out.terms.push_back(std::move(to));
    }
    std::vector<PrintedTerm> printed;
    for (std::size_t j = 0; j < out.terms.size(); ++j)
      if (out.terms[j].kept) printed.push_back({j, out.terms[j].coefficient, out.terms[j].sd});
    out.equation = equation_text(equation, printed);
    for (std::size_t s = 0; s < found.supports.size() && s < static_cast<std::size_t>(of_.what.top); ++s) {
      regression::Support const& support = found.supports[s];
      DiscoveredSupport to{{}, support.probability, support.probability_error, support.log_evidence};
      for (int const j : support.terms)
        if (!equation.terms[static_cast<std::size_t>(j)].in_target)
          to.terms.push_back(equation.terms[static_cast<std::size_t>(j)].text);
      out.supports.push_back(std::move(to));
    }
    return out;
  }

  std::string prior_text(std::string const& parameter) const {
    for (ast::DictionaryStatement const& statement : of_.dictionary.tree.statements)
      if (auto const* each = std::get_if<ast::DictionaryParameter>(&statement);
          each != nullptr && each->prior && each->name.name.text == parameter)
        return unparse(ast::Expression{{}, *each->prior});
    return "";
  }

  DiscoveryInWords const& of_;
};

}  // namespace

DiscoveryReport described_discovery(DiscoveryInWords const& of, regression::Discovery const& found,
                                    regression::SelectorRow const& selector) {
  return InWords(of).report(found, selector);
}

}  // namespace sysid
