// Starts `sysid lsp` for files of the language; everything else is the server's.
const { workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

function activate() {
  const program = workspace.getConfiguration("sysid").get("program");
  client = new LanguageClient(
    "sysid",
    "sysid",
    { command: program, args: ["lsp"] },
    { documentSelector: [{ scheme: "file", language: "sysid" }] },
  );
  return client.start();
}

function deactivate() {
  return client ? client.stop() : undefined;
}

module.exports = { activate, deactivate };
