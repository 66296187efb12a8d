// What the server answers, a file each. params: of the request; results: as the protocol has them. RequestError and the exceptions
// of Json are answered as errors.
#pragma once
#include "lsp/documents.hpp"

namespace sysid::lsp {

/// textDocument/publishDiagnostics: the messages of `sysid check` about the text and its data.
Json diagnostics(Documents& documents, Document& document);

Json hover(Documents& documents, Json const& params);
Json completion(Documents& documents, Json const& params);
Json definition(Documents& documents, Json const& params);
Json references(Documents& documents, Json const& params);
Json document_highlight(Documents& documents, Json const& params);
Json prepare_rename(Documents& documents, Json const& params);
Json rename(Documents& documents, Json const& params);
Json formatting(Documents& documents, Json const& params);
Json document_symbols(Documents& documents, Json const& params);

/// The document that a request names, and the place in it.
Document& document_of(Documents& documents, Json const& params);
ReadPlace place_of(Documents& documents, Json const& params);

}  // namespace sysid::lsp
