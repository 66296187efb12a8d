// Reads the sections of the Markdown pages of errors; it handles only the Markdown that these pages use, which a test checks.
#include "app/catalogue/explain.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sysid {
namespace {

constexpr std::string_view fence = "```";

bool is_sysid(Example const& example) { return example.kind == "sysid" || example.kind == "sysid file"; }
bool is_frame(Example const& example) { return example.kind == "sysid inside" || example.kind == "sysid above"; }

std::string_view first_line(std::string_view& text) {
  auto const end = text.find('\n');
  std::string_view const line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

// The code in "## E2001: title" and "## chains_disagree: title"; empty for other lines.
std::string_view code_of_heading(std::string_view line) {
  if (!line.starts_with("## ")) return {};
  std::string_view const code = line.substr(3, line.find(':') - 3);
  bool const one_word = std::all_of(
      code.begin(), code.end(), [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == 'E'; });
  return one_word && line.size() > code.size() + 5 ? code : std::string_view();
}
bool heads_section(std::string_view line) { return !code_of_heading(line).empty(); }

std::string indented(std::string_view text, std::string_view by) {
  std::string result;
  while (!text.empty()) {
    std::string_view const line = first_line(text);
    if (!line.empty()) result += fmt::format("{}{}", by, line);
    result += '\n';
  }
  return result;
}

std::string shown(Example const& example) {
  std::string const name = example.file_name();
  return (name.empty() ? name : fmt::format("    {}:\n", name)) + indented(example.text, "    ");
}

// Markdown without its fences.
std::string plain(std::string_view body) {
  std::string result;
  while (!body.empty()) {
    std::string_view const line = first_line(body);
    if (!line.starts_with(fence)) {
      result += fmt::format("{}\n", line);
      continue;
    }
    Example example{std::string(line.substr(fence.size())), {}};
    while (!body.empty()) {
      std::string_view const inner = first_line(body);
      if (inner.starts_with(fence)) break;
      example.text += fmt::format("{}\n", inner);
    }
    result += shown(example);
  }
  return result;
}

bool stands_alone(std::vector<Example> const& examples) {
  return std::any_of(examples.begin(), examples.end(), [](Example const& example) { return example.kind == "sysid file"; });
}

class PageReader {
 public:
  std::vector<ErrorSection> read(std::string_view page) {
    while (!page.empty()) {
      std::string_view const line = first_line(page);
      if (heads_section(line)) {
        std::string_view const code = code_of_heading(line);
        sections_.push_back({std::string(code), std::string(line.substr(code.size() + 5)), {}, {}, {}, frame_});
        into_ = nullptr;
      }
      bool const heads_other = line.starts_with("# ") || line.starts_with("## ");
      in_section_ = heads_section(line) || (in_section_ && !heads_other);
      if (line.starts_with(fence)) {
        block(line, page);
        continue;
      }
      if (!in_section_ || heads_section(line)) continue;
      if (line == "Bad:") into_ = &ErrorSection::bad;
      if (line == "Corrected:") into_ = &ErrorSection::mended;
      sections_.back().body += fmt::format("{}\n", line);
    }
    return std::move(sections_);
  }

 private:
  void block(std::string_view opening, std::string_view& page) {
    Example example{std::string(opening.substr(fence.size())), {}};
    std::string body = fmt::format("{}\n", opening);
    while (!page.empty()) {
      std::string_view const line = first_line(page);
      body += fmt::format("{}\n", line);
      if (line.starts_with(fence)) break;
      example.text += fmt::format("{}\n", line);
    }
    if (in_section_) {
      sections_.back().body += body;
      if (into_ != nullptr) (sections_.back().*into_).push_back(std::move(example));
    } else if (is_frame(example)) {
      frame_.clear();
      frame_.push_back(std::move(example));
    } else if (!frame_.empty()) {
      frame_.push_back(std::move(example));
    }
  }

  std::vector<ErrorSection> sections_;
  std::vector<Example> frame_;
  bool in_section_ = false;
  std::vector<Example> ErrorSection::*into_ = nullptr;
};

}  // namespace

std::string Example::file_name() const {
  for (std::string_view const word : {"csv ", "module "})
    if (kind.starts_with(word)) return kind.substr(word.size());
  return {};
}

std::string ErrorSection::complete(std::vector<Example> const& examples) const {
  std::string own;
  for (Example const& example : examples)
    if (is_sysid(example)) own += example.text;
  if (frame.empty() || stands_alone(examples)) return own;
  std::string whole = frame.front().text;
  if (frame.front().kind == "sysid above") return whole + own;
  auto const brace = whole.rfind("\n}");
  return whole.substr(0, brace + 1) + indented(own, "  ") + whole.substr(brace + 1);
}

std::vector<ErrorSection> read_error_page(std::string_view page) { return PageReader().read(page); }

std::vector<ErrorSection> const& error_sections() {
  static std::vector<ErrorSection> const sections = [] {
    std::vector<ErrorSection> all;
    for (std::string_view const page : error_pages())
      for (ErrorSection& section : read_error_page(page)) all.push_back(std::move(section));
    return all;
  }();
  return sections;
}

std::optional<std::string> explain(std::string_view code) {
  std::string wanted(code);
  if (wanted.size() > 1 && wanted.front() == 'e' && wanted[1] >= '0' && wanted[1] <= '9') wanted.front() = 'E';
  if (!wanted.empty() && wanted.front() >= '0' && wanted.front() <= '9') wanted.insert(wanted.begin(), 'E');
  for (ErrorSection const& section : error_sections()) {
    if (section.code != wanted) continue;
    std::string text = fmt::format("{}: {}\n{}", section.code, section.title, plain(section.body));
    while (text.ends_with("\n\n")) text.pop_back();
    bool const has_example = !section.bad.empty() || !section.mended.empty();
    if (has_example && !section.frame.empty() && !stands_alone(section.bad)) {
      text += section.frame.front().kind == "sysid inside" ? "\nThe lines above are part of the model of this file:\n\n"
                                                           : "\nThe lines above continue this file:\n\n";
      for (Example const& example : section.frame) text += shown(example);
    }
    return text;
  }
  return std::nullopt;
}

std::vector<std::string> codes() {
  std::vector<std::string> all;
  for (ErrorSection const& section : error_sections()) all.push_back(section.code);
  return all;
}

std::string list_codes() {
  std::string text;
  for (bool const findings : {false, true})
    for (ErrorSection const& section : error_sections())
      if (section.of_finding() == findings) text += fmt::format("{:<{}}  {}\n", section.code, findings ? 24 : 5, section.title);
  return text;
}

}  // namespace sysid
