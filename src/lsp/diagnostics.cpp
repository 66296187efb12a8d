// Diagnostics of the compiler as those of an editor.
#include <algorithm>
#include <filesystem>

#include "lsp/features.hpp"

namespace sysid::lsp {
namespace {

int severity(Severity severity) { return severity == Severity::error ? 1 : severity == Severity::warning ? 2 : 3; }

/// Where the file uses the module in which the mistake lies.
Span use_of(assist::Reading const* reading, std::string const& module_file) {
  std::string const module = std::filesystem::path(module_file).stem().string();
  if (reading != nullptr)
    for (ast::Item const& item : reading->tree.items)
      if (auto const* use = std::get_if<ast::Use>(&item); use != nullptr && use->module.text == module) return use->module.span;
  return {};
}

Json as_json(Diagnostic const& diagnostic, Source const& source, assist::Reading const* reading) {
  Lines const lines(source.text());
  Json related = Json::array();
  auto const relate = [&](Label const& label) {
    related.push_back({{"location", location(source, label.span)}, {"message", label.text.empty() ? "here" : label.text}});
  };
  Json where = range(lines, {0, 0});
  std::string message = diagnostic.message;
  if (diagnostic.primary) {
    if (int const file = source.place(diagnostic.primary->span.begin).file; file == 0) {
      where = range(lines, diagnostic.primary->span);
      if (!diagnostic.primary->text.empty()) message += "\n" + diagnostic.primary->text;
    } else {
      where = range(lines, use_of(reading, source.name(file)));
      relate(*diagnostic.primary);
    }
  }
  for (Label const& label : diagnostic.secondary) relate(label);
  if (!diagnostic.help.empty()) message += "\nhelp: " + diagnostic.help;
  Json out = {{"range", where}, {"severity", severity(diagnostic.severity)}, {"source", "sysid"}, {"message", message}};
  if (!diagnostic.code.empty()) out["code"] = diagnostic.code;
  if (!related.empty()) out["relatedInformation"] = related;
  return out;
}

}  // namespace

Json diagnostics(Documents& documents, Document& document) {
  document.asked.clear();
  auto const text_of = [&, unsaved = documents.unsaved()](std::string const& path) {
    document.asked.push_back(uri_of(path));
    return unsaved(path);
  };
  assist::Analysis const found = assist::analyse(document.path, document.text, text_of);
  document.analysed = true;
  Json all = Json::array();
  for (Diagnostic const& each : found.diagnostics.all()) {
    bool const elsewhere = each.primary && found.source.place(each.primary->span.begin).file > 0;
    Json one = as_json(each, found.source, elsewhere ? documents.reading(document) : nullptr);
    // A statement that stands for several may be found wrong several times.
    if (std::find(all.begin(), all.end(), one) == all.end()) all.push_back(std::move(one));
  }
  return {{"uri", document.uri}, {"version", document.version}, {"diagnostics", all}};
}

}  // namespace sysid::lsp
