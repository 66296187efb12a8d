// Edits of a text by the places of its syntax tree.
#include "app/disturbed/changed_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "syntax/find_model.hpp"
#include "syntax/parse.hpp"

namespace sysid {
namespace {

struct Edit {
  Span place;  // empty: text goes in before it
  std::string text;
};

/// The text at `whole` after the edits, which do not overlap.
std::string edited(Source const& source, Span whole, std::vector<Edit> edits) {
  std::stable_sort(edits.begin(), edits.end(), [](Edit const& a, Edit const& b) { return a.place.begin < b.place.begin; });
  std::string text;
  std::uint32_t done = whole.begin;
  for (Edit const& edit : edits) {
    if (edit.place.begin < whole.begin || edit.place.end > whole.end) continue;
    text += source.text(Span{done, edit.place.begin});
    text += edit.text;
    done = edit.place.end;
  }
  return text + std::string(source.text(Span{done, whole.end}));
}

Span whole_file(Source const& source) { return {0, static_cast<std::uint32_t>(source.text(0).size())}; }

/// What stands before a place in its line, where that is blank.
std::string indent_at(Source const& source, std::uint32_t offset) {
  std::string indent(source.text(Span{source.line_begin(source.place(offset).line), offset}));
  return std::all_of(indent.begin(), indent.end(), [](char each) { return each == ' ' || each == '\t'; }) ? indent : "  ";
}

std::string declared(std::string const& name, std::string const& unit) {
  return unit.empty() ? name : fmt::format("{} [{}]", name, unit);
}

/// "N^2 s" of "N".
std::string unit_of_intensity(std::string const& unit) {
  if (unit.empty()) return "";
  if (unit == "1" || unit == "-") return "s";
  bool const plain =
      std::all_of(unit.begin(), unit.end(), [](char each) { return std::isalpha(static_cast<unsigned char>(each)); });
  return plain ? fmt::format("{}^2 s", unit) : fmt::format("({})^2 s", unit);
}

/// The power of ten next to a number above 0: "1e-9".
std::string round_number(double value) {
  auto const power = static_cast<int>(std::round(std::log10(value)));
  return std::abs(power) < 4 ? fmt::format("{:g}", std::pow(10, power)) : fmt::format("1e{}", power);
}

/// The line with this statement, or the statement alone where others share the line.
Span line_of(Source const& source, Span statement) {
  std::string_view const text = source.text(0);
  auto const blank = [](char each) { return each == ' ' || each == '\t'; };
  std::uint32_t begin = statement.begin, end = statement.end;
  while (begin > 0 && blank(text[begin - 1])) --begin;
  while (end < text.size() && blank(text[end])) ++end;
  bool const alone = (begin == 0 || text[begin - 1] == '\n') && (end == text.size() || text[end] == '\n');
  return alone ? Span{begin, std::min<std::uint32_t>(end + 1, static_cast<std::uint32_t>(text.size()))} : statement;
}

std::string quoted_path(std::string const& path) {
  std::string text = "\"";
  for (char const each : path) text += each == '"' || each == '\\' ? std::string("\\") + each : std::string(1, each);
  return text + "\"";
}

/// The file of a data block as seen from another folder.
std::string path_from(std::filesystem::path const& results, std::filesystem::path const& file) {
  auto const place = [](std::filesystem::path const& path) {
    return std::filesystem::absolute(path.empty() ? "." : path).lexically_normal();
  };
  std::filesystem::path const seen = place(file).lexically_relative(place(results));
  return (seen.empty() ? place(file) : seen).string();
}

class FileChange {
 public:
  FileChange(Source const& source, Task const& fit, std::filesystem::path const& results)
      : source_(source), fit_(fit), results_(results) {}

  std::vector<Edit> edits(ast::File const& tree) {
    for (ast::Item const& item : tree.items) {
      if (auto const* data = std::get_if<ast::Data>(&item)) move_path(*data);
      if (auto const* task = std::get_if<ast::Task>(&item)) change(*task);
    }
    return std::move(edits_);
  }

 private:
  void move_path(ast::Data const& data) {
    std::filesystem::path const home = std::filesystem::path(source_.name()).parent_path();
    for (ast::DataStatement const& statement : data.statements)
      if (auto const* file = std::get_if<ast::DataFile>(&statement))
        edits_.push_back({file->path.span, quoted_path(path_from(results_, home / file->path.value))});
  }

  void change(ast::Task const& task) {
    // By its place: a fit without a name is called after a model of a family, which the text names without its arguments.
    bool const is_fit = task.verb.text == "fit" && task.span.begin <= fit_.span.begin && fit_.span.begin < task.span.end;
    bool const of_fit = task.verb.text == "predict" && task.subject.text == fit_.name && task.others.empty();
    if (!is_fit && !of_fit) {
      edits_.push_back({line_of(source_, task.span), ""});
      return;
    }
    std::string const name = changed_name(is_fit ? fit_.name : task.called());
    if (task.name)
      edits_.push_back({task.name->span, name});
    else
      edits_.push_back({{task.span.begin, task.span.begin}, name + " = "});
    if (of_fit) edits_.push_back({task.subject.span, changed_name(task.subject.text)});
    for (ast::Option const& option : task.options)
      if (option.key && option.key->text == "search") edits_.push_back({option.value.span, "everywhere"});  // the other fit is gone
  }

  Source const& source_;
  Task const& fit_;
  std::filesystem::path const& results_;
  std::vector<Edit> edits_;
};

std::vector<Edit> disturbance_edits(Source const& source, std::vector<DisturbedEquation> const& equations,
                                    std::vector<DisturbanceSize> const& sizes) {
  std::vector<Edit> edits;
  for (std::size_t i = 0; i < equations.size(); ++i)
    edits.push_back(
        {equations[i].place, text_with_disturbance(equations[i], sizes[i], indent_at(source, equations[i].place.begin))});
  return edits;
}

ast::File tree_of(Source const& source) {
  Diagnostics ignored;
  auto tree = parse(source, ignored);
  if (!tree) throw InternalError("a file that was checked does not parse");
  return std::move(*tree);
}

}  // namespace

std::string changed_name(std::string const& task) { return task + "_with_disturbance"; }

std::string text_with_probes(Source const& source, std::vector<DisturbedEquation> const& equations) {
  std::vector<Edit> edits;
  for (DisturbedEquation const& each : equations)
    edits.push_back(
        {{each.place.begin, each.place.begin},
         fmt::format("derive {}{} = {}\n{}", each.probe(), each.sizes, each.inertia, indent_at(source, each.place.begin))});
  return edited(source, whole_file(source), std::move(edits));
}

std::string text_with_disturbance(DisturbedEquation const& equation, DisturbanceSize const& size, std::string const& indent) {
  // What has the size of the whole motion, and what no record could show: 1e-4 of a force is far below the noise of sensors.
  constexpr double least = 1e-4, most = 10;
  constexpr double lasting = 3;  // samples: nearly white for what is slower than the sampling
  std::string const parameter = equation.parameter(), name = equation.name + equation.sizes;
  double const whole = equation.white() ? size.size * size.size * size.step : size.size;
  double const low = equation.white() ? least * least : least, high = equation.white() ? most * most : most;
  std::string const unit = equation.white() ? unit_of_intensity(size.unit) : size.unit;
  std::string const prior = fmt::format("parameter {} ~ log_uniform({}, {})", declared(parameter, unit), round_number(low * whole),
                                        round_number(high * whole));
  std::string const law = equation.white() ? fmt::format("white(intensity = {})", parameter)
                          : equation.discrete
                              ? fmt::format("normal(0, sd = {})", parameter)
                              : fmt::format("ornstein_uhlenbeck(sd = {}, time = {:g})", parameter, lasting * size.step);
  std::string const rms = !equation.white() ? ""
                                            : fmt::format("{}derive {} = sqrt({}/({:g} [s]))\n", indent,
                                                          declared(equation.name + "_rms", size.unit), parameter, size.step);
  std::string const about =
      fmt::format("what acts in this equation and was not measured; its prior spans 1e-4 to 10 times the rms of {}{}",
                  equation.discrete ? "the state that it determines" : "its term with the highest derivative",
                  equation.white() ? ", compared as means over a sampling interval" : "");
  std::string const right = equation.right.empty()  ? equation.name
                            : equation.right_closed ? fmt::format("{} + {}", equation.right, equation.name)
                                                    : fmt::format("({}) + {}", equation.right, equation.name);
  return fmt::format("# {}\n{}{}\n{}disturbance {} ~ {}\n{}{}{} = {}", about, indent, prior, indent, declared(name, size.unit), law,
                     rms, indent, equation.left, right);
}

std::string text_with_disturbances(Source const& source, Task const& fit, std::vector<DisturbedEquation> const& equations,
                                   std::vector<DisturbanceSize> const& sizes, std::filesystem::path const& results) {
  std::vector<Edit> edits = FileChange(source, fit, results).edits(tree_of(source));
  for (Edit& each : disturbance_edits(source, equations, sizes)) edits.push_back(std::move(each));
  std::string const about =
      fmt::format("# {} as `sysid fit --with-disturbance` has changed it: a disturbance in the model of `{}`\n",
                  std::filesystem::path(source.name()).filename().string(), fit.name);
  return about + edited(source, whole_file(source), std::move(edits));
}

std::string model_with_disturbances(Source const& source, std::string const& model, std::string const& name,
                                    std::vector<DisturbedEquation> const& equations, std::vector<DisturbanceSize> const& sizes) {
  std::vector<Edit> edits = disturbance_edits(source, equations, sizes);
  ast::File const tree = tree_of(source);
  ast::Model const* const written = find_model(tree, model);
  if (written == nullptr) throw InternalError("a model that was disturbed is not in the file");
  edits.push_back({written->name.span, name});
  return edited(source, written->span, std::move(edits));
}

}  // namespace sysid
