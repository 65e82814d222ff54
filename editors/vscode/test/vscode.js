// The part of VS Code's interface that the extension and vscode-languageclient use, without an editor.
// Documents are opened and changed by `editor`; providers and findings are kept in it.
"use strict";
const { EventEmitter } = require("node:events");
const { pathToFileURL, fileURLToPath } = require("node:url");

const bus = new EventEmitter().setMaxListeners(0);
class Disposable {
  constructor(end) { this.dispose = end; }
  static from(...all) { return new Disposable(() => all.forEach((each) => each.dispose())); }
}
const disposable = (end = () => {}) => new Disposable(end);

class Position {
  constructor(line, character) { Object.assign(this, { line, character }); }
}
class Range {
  constructor(start, end, ...more) {
    if (typeof start === "number") [start, end] = [new Position(start, end), new Position(...more)];
    Object.assign(this, { start, end });
  }
}
class Uri {
  constructor(text) { this.text = text; this.scheme = text.split(":")[0]; this.path = new URL(text).pathname; }
  static parse(text) { return new Uri(text); }
  static file(path) { return new Uri(pathToFileURL(path).href); }
  get fsPath() { return fileURLToPath(this.text); }
  toString() { return this.text; }
}
class Document {
  constructor(path, languageId, text) {
    Object.assign(this, { uri: Uri.file(path), languageId, text, version: 1, isClosed: false, fileName: path });
  }
  getText() { return this.text; }
}

class CodeActionKind {
  constructor(value) { this.value = value; }
  append(part) { return new CodeActionKind(this.value ? `${this.value}.${part}` : part); }
}
const kinds = ["", "quickfix", "refactor", "refactor.extract", "refactor.inline", "refactor.rewrite", "source"];
const kindNames = ["Empty", "QuickFix", "Refactor", "RefactorExtract", "RefactorInline", "RefactorRewrite", "Source"];
kindNames.forEach((name, number) => { CodeActionKind[name] = new CodeActionKind(kinds[number]); });

const editor = {
  findings: new Map(), // by URI
  providers: {}, // by the name of the function that registered them
  open(path, languageId, text) {
    const document = new Document(path, languageId, text);
    workspace.textDocuments.push(document);
    bus.emit("onDidOpenTextDocument", document);
    return document;
  },
  replace(document, old, text) {
    const offset = document.text.indexOf(old);
    const before = document.text.slice(0, offset).split("\n");
    const start = new Position(before.length - 1, before.at(-1).length);
    const range = new Range(start, new Position(start.line, start.character + old.length));
    document.text = document.text.replace(old, text);
    document.version += 1;
    const contentChanges = [{ range, rangeOffset: offset, rangeLength: old.length, text }];
    bus.emit("onDidChangeTextDocument", { document, contentChanges });
    return start;
  },
};

// What is not written out: an event, a function that registers something, or a function that does nothing.
function fill(name, known) {
  return new Proxy(known, {
    get(target, key) {
      if (key in target || typeof key === "symbol") return target[key];
      if (/^on(Did|Will)/.test(key)) {
        return (listener, self) => {
          const call = (event) => listener.call(self, event);
          bus.on(key, call);
          return disposable(() => bus.off(key, call));
        };
      }
      if (/^register/.test(key)) {
        return (first, provider) => {
          editor.providers[key] = name === "commands" ? [...(editor.providers[key] ?? []), first] : provider;
          return disposable();
        };
      }
      if (/^show/.test(key)) return async () => undefined;
      return /^(create|set)/.test(key) ? () => fill(key, disposable()) : undefined;
    },
  });
}

const watcher = () => fill("watcher", disposable());
const workspace = fill("workspace", {
  textDocuments: [],
  notebookDocuments: [],
  workspaceFolders: [],
  createFileSystemWatcher: watcher,
  getConfiguration: (section) => ({
    get: (key, other) => process.env[`TEST_${section}_${key}`.replaceAll(".", "_").toUpperCase()] ?? other,
    has: () => false,
  }),
});
const languages = fill("languages", {
  match: (selector, document) => (selector.some((each) => each.language === document.languageId) ? 10 : 0),
  createDiagnosticCollection: () => ({
    set: (uri, found) => { editor.findings.set(uri.toString(), found); bus.emit("findings"); },
    delete: (uri) => editor.findings.delete(uri.toString()),
    clear: () => editor.findings.clear(),
    dispose: () => {},
  }),
});
const enumeration = (...names) => Object.fromEntries(names.map((name, number) => [name, number]));
const classes = { Position, Range, Uri, CodeActionKind, Disposable };

module.exports = new Proxy({
  ...classes, editor, bus, workspace, languages,
  version: "1.82.0",
  env: { language: "en", appName: "test" },
  window: fill("window", {
    createOutputChannel: () => fill("channel", {
      append: (text) => process.stderr.write(text), appendLine: (text) => console.error(text), dispose: () => {},
    }),
    tabGroups: fill("tabGroups", { all: [] }), visibleTextEditors: [] }),
  commands: fill("commands", { executeCommand: async () => undefined }),
  extensions: fill("extensions", { getExtension: () => undefined }),
  DiagnosticSeverity: enumeration("Error", "Warning", "Information", "Hint"),
  CancellationTokenSource: class {
    constructor() { this.token = { isCancellationRequested: false, onCancellationRequested: () => disposable() }; }
    cancel() { this.token.isCancellationRequested = true; }
    dispose() {}
  },
  EventEmitter: class {
    constructor() { this.inner = new EventEmitter(); this.event = (call) => { this.inner.on("event", call); return disposable(); }; }
    fire(value) { this.inner.emit("event", value); }
    dispose() { this.inner.removeAllListeners(); }
  },
}, {
  // Values like a completion item: what they are made of is kept in the order of the arguments.
  get(target, key) {
    if (!(key in target) && /^[A-Z]/.test(String(key))) {
      const names = { Location: ["uri", "range"], Diagnostic: ["range", "message", "severity"], Hover: ["contents", "range"] };
      target[key] = class {
        constructor(...all) { all.forEach((value, number) => { this[names[key]?.[number] ?? `argument${number}`] = value; }); }
      };
    }
    return target[key];
  },
});
