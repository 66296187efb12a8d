// client.js EXTENSION PROGRAM FILE: the protocol library of the extension with the server.
const fs = require("fs");
const path = require("path");
const assert = require("assert");
const { spawn } = require("child_process");

const [extension, program, file] = process.argv.slice(2);
const protocol = require(path.resolve(extension, "node_modules/vscode-languageserver-protocol/node.js"));

async function main() {
  // As extension.js starts it.
  const about = JSON.parse(fs.readFileSync(path.join(extension, "package.json")));
  assert.strictEqual(about.contributes.configuration.properties["sysid.program"].default, "sysid");
  const server = spawn(program, ["lsp"]);
  const connection = protocol.createProtocolConnection(
    new protocol.StreamMessageReader(server.stdout),
    new protocol.StreamMessageWriter(server.stdin),
  );
  const published = new Promise((resolve) => connection.onNotification(protocol.PublishDiagnosticsNotification.type, resolve));
  connection.listen();
  const begun = await connection.sendRequest(protocol.InitializeRequest.type, { processId: null, rootUri: null, capabilities: {} });
  assert.ok(begun.capabilities.hoverProvider);
  await connection.sendNotification(protocol.InitializedNotification.type, {});
  const text = fs.readFileSync(file, "utf8").replace("c*y' +", "c*y +");
  const uri = `file://${path.resolve(file)}`;
  await connection.sendNotification(protocol.DidOpenTextDocumentNotification.type, {
    textDocument: { uri, languageId: "sysid", version: 1, text },
  });
  const { diagnostics } = await published;
  assert.deepStrictEqual(diagnostics.map((each) => each.code), ["E2103"]);
  const line = text.split("\n").findIndex((each) => each.includes("c*y +"));
  const position = { line, character: text.split("\n")[line].indexOf("c*y") };
  const hover = await connection.sendRequest(protocol.HoverRequest.type, { textDocument: { uri }, position });
  assert.match(hover.contents.value, /parameter c/);
  const items = await connection.sendRequest(protocol.CompletionRequest.type, { textDocument: { uri }, position });
  assert.ok(items.items.some((each) => each.label === "k3"));
  await connection.sendRequest(protocol.ShutdownRequest.type);
  await connection.sendNotification(protocol.ExitNotification.type);
  await new Promise((resolve) => server.on("exit", resolve));
  console.log("client: diagnostics, hover and completion");
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
