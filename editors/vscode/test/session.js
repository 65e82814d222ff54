// A scripted session of the built extension with vscode-languageclient and a server: `node session.js FOLDER FILE`.
// FOLDER holds `out` and `node_modules`; TEST_UR_COMMAND is the command ur.
"use strict";
const fs = require("node:fs");
const Module = require("node:module");
const path = require("node:path");

const [folder, file] = process.argv.slice(2).map((each) => path.resolve(each));
const resolve = Module._resolveFilename;
Module._resolveFilename = function (name, ...more) {
  return name === "vscode" ? path.join(__dirname, "vscode.js") : resolve.call(this, name, ...more);
};
const vscode = require("vscode");
const extension = require(path.join(folder, "out", "extension.js"));

async function report(document, count) {
  const found = () => vscode.editor.findings.get(document.uri.toString());
  while (found()?.length !== count) await new Promise((next) => vscode.bus.once("findings", next));
  const text = found().map((each) => `${each.code?.value ?? each.code}:${each.range.start.line}`).join(" ");
  console.log(`findings [${text}]`);
}

async function main() {
  const root = vscode.Uri.file(path.dirname(path.dirname(file)));
  vscode.workspace.workspaceFolders.push({ uri: root, name: path.basename(root.path), index: 0 });
  await extension.activate({ subscriptions: [] });
  const document = vscode.editor.open(file, "roslaunch", fs.readFileSync(file, "utf8"));
  await report(document, 1);
  const start = vscode.editor.replace(document, "sped)", "speed)");
  await report(document, 0);
  const { token } = new vscode.CancellationTokenSource();
  const provider = vscode.editor.providers.registerDefinitionProvider;
  const places = await provider.provideDefinition(document, start, token);
  console.log(`definition line ${[places].flat()[0].range.start.line}`);
  console.log(`commands ${vscode.editor.providers.registerCommand.filter((each) => /^ur[.](graph|launch)$/.test(each)).sort().join(" ")}`);
  await extension.deactivate();
}

const limit = setTimeout(() => { console.error("no answer within 100 s"); process.exit(1); }, 100_000);
main().then(() => clearTimeout(limit), (problem) => { console.error(problem); process.exit(1); });
