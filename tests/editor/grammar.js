// grammar.js EXTENSION MODELS: every line of the shipped models is read to its end, and known words have their scopes.
const fs = require("fs");
const path = require("path");
const assert = require("assert");
const { Registry, parseRawGrammar, INITIAL } = require("vscode-textmate");
const oniguruma = require("vscode-oniguruma");

const [extension, models] = process.argv.slice(2);

function texts(folder) {
  return fs.readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const place = path.join(folder, entry.name);
    if (entry.isDirectory()) return entry.name === "results" ? [] : texts(place);
    return entry.name.endsWith(".sysid") ? [fs.readFileSync(place, "utf8")] : [];
  });
}

async function main() {
  await oniguruma.loadWASM(fs.readFileSync(require.resolve("vscode-oniguruma/release/onig.wasm")).buffer);
  const file = path.join(extension, "sysid.tmLanguage.json");
  const registry = new Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async () => parseRawGrammar(fs.readFileSync(file, "utf8"), file),
  });
  const grammar = await registry.loadGrammar("source.sysid");
  let lines = 0;
  let coloured = 0;
  const scopes = (text) => {
    let state = INITIAL;
    return text.split("\n").map((line) => {
      const read = grammar.tokenizeLine(line, state);
      state = read.ruleStack;
      assert.ok(!read.stoppedEarly, line);
      assert.strictEqual(read.tokens.at(-1).endIndex >= line.length, true, line);
      lines += 1;
      coloured += read.tokens.filter((token) => token.scopes.length > 1).length;
      return read.tokens.map((token) => [line.slice(token.startIndex, token.endIndex).trim(), token.scopes.at(-1)]);
    });
  };
  const found = texts(models);
  assert.ok(found.length > 20, `${found.length} models`);
  found.forEach(scopes);
  const scope = (line, word) => scopes(line)[0].find(([text]) => text.includes(word))?.[1] ?? "none";
  assert.match(scope("model duffing {", "model"), /^keyword|^storage/);
  assert.match(scope("# a comment", "a comment"), /comment/);
  assert.match(scope('  file "record.csv"', "record.csv"), /^string/);
  assert.match(scope("  parameter k3 [N/m^3] ~ log_uniform(5e8, 5e10)", "log_uniform"), /^support|^entity/);
  assert.match(scope("  parameter k3 [N/m^3] ~ log_uniform(5e8, 5e10)", "5e8"), /^constant\.numeric/);
  console.log(`grammar: ${found.length} models, ${lines} lines, ${coloured} coloured pieces`);
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
