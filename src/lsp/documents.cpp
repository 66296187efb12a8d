// Opening, changing and reading texts.
#include "lsp/documents.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "syntax/words.hpp"

namespace sysid::lsp {
namespace {

constexpr std::string_view scheme = "file://";

int hexadecimal(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

std::string path_of(std::string const& uri) {
  if (!uri.starts_with(scheme)) return uri;
  std::string path;
  for (std::size_t i = scheme.size(); i < uri.size(); ++i) {
    bool const escaped = uri[i] == '%' && i + 2 < uri.size() && hexadecimal(uri[i + 1]) >= 0 && hexadecimal(uri[i + 2]) >= 0;
    path += escaped ? static_cast<char>(16 * hexadecimal(uri[i + 1]) + hexadecimal(uri[i + 2])) : uri[i];
    if (escaped) i += 2;
  }
  return path;
}

std::string uri_of(std::string const& path) {
  std::string uri(scheme);
  for (char const c : std::filesystem::absolute(path).lexically_normal().string()) {
    bool const plain = words::is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       std::string_view("/-._~").find(c) != std::string_view::npos;
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

Document& Documents::open(std::string const& uri, std::string text, std::int64_t version) {
  Document& document = all_[uri];
  document = {};
  document.uri = uri;
  document.path = path_of(uri);
  document.text = std::move(text);
  document.version = version;
  touch_users(document);
  return document;
}

void Documents::close(std::string const& uri) {
  // What is in the file counts from now on.
  touch_users(at(uri));
  all_.erase(uri);
}

void Documents::touch_users(Document const& module) {
  for (auto& [uri, document] : all_)
    if (std::find(document.asked.begin(), document.asked.end(), uri_of(module.path)) != document.asked.end()) {
      document.analysed = false;
      document.read = false;
    }
}

Document& Documents::at(std::string const& uri) {
  auto const found = all_.find(uri);
  if (found == all_.end()) throw RequestError(invalid_params, "`" + uri + "` is not open");
  return found->second;
}

void Documents::change(Document& document, Json const& changes, std::int64_t version) {
  for (Json const& change : changes) {
    std::string const& text = change.at("text").get_ref<std::string const&>();
    auto const where = change.find("range");
    if (where == change.end() || where->is_null()) {
      document.text = text;
      continue;
    }
    Lines const lines(document.text);
    std::uint32_t const begin = lines.offset(position_from(where->at("start"))),
                        end = lines.offset(position_from(where->at("end")));
    document.text.replace(begin, std::max(begin, end) - begin, text);
  }
  document.version = version;
  document.analysed = false;
  document.read = false;
  document.reading = nullptr;
  touch_users(document);
}

UnsavedText Documents::unsaved() const {
  return [this](std::string const& path) -> std::optional<std::string> {
    // Clients may escape more of a path than we do.
    std::string const wanted = uri_of(path);
    for (auto const& [uri, document] : all_)
      if (uri_of(document.path) == wanted) return document.text;
    return std::nullopt;
  };
}

assist::Reading const* Documents::reading(Document& document) {
  if (!document.read) {
    document.reading = assist::read(document.path, document.text, unsaved());
    document.read = true;
    if (document.reading) {
      document.last_reading = document.reading;
      document.last_text = document.text;
    }
  }
  return document.reading.get();
}

ReadPlace read_place(Documents& documents, Document& document, Position position) {
  std::uint32_t const offset = Lines(document.text).offset(position);
  if (documents.reading(document) != nullptr) return {document.reading, offset};
  if (!document.last_reading) return {};
  // What stands before the change, or behind it, is where it was, or moved by as much as the text grew.
  std::string const &now = document.text, &then = document.last_text;
  std::size_t const shorter = std::min(now.size(), then.size());
  std::size_t const same = static_cast<std::size_t>(
      std::mismatch(now.begin(), now.begin() + static_cast<std::ptrdiff_t>(shorter), then.begin()).first - now.begin());
  if (offset <= same) return {document.last_reading, offset};
  std::int64_t const moved =
      static_cast<std::int64_t>(offset) + static_cast<std::int64_t>(then.size()) - static_cast<std::int64_t>(now.size());
  return {document.last_reading,
          static_cast<std::uint32_t>(std::clamp<std::int64_t>(moved, 0, static_cast<std::int64_t>(then.size())))};
}

Position position_from(Json const& json) { return {json.at("line").get<int>(), json.at("character").get<int>()}; }
Json to_json(Position position) { return {{"line", position.line}, {"character", position.character}}; }
Json range(Lines const& lines, Span span) {
  return {{"start", to_json(lines.position(span.begin))}, {"end", to_json(lines.position(span.end))}};
}

Json location(Source const& source, Span span) {
  int const file = source.place(span.begin).file;
  std::uint32_t const begin = source.line_begin(1, file);
  return {{"uri", uri_of(source.name(file))},
          {"range", range(Lines(source.text(file)), {span.begin - begin, std::max(span.end, span.begin) - begin})}};
}

}  // namespace sysid::lsp
