// Starts `ur lsp` for launch files; everything else is the server's.
import * as vscode from "vscode";
import { LanguageClient } from "vscode-languageclient/node";

let client: LanguageClient | undefined;

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  const command = vscode.workspace.getConfiguration("ur").get<string>("command", "ur");
  client = new LanguageClient("ur", "ROS launch files", { command, args: ["lsp"] }, {
    documentSelector: [
      { scheme: "file", language: "roslaunch" },
      { scheme: "file", language: "yaml" },
      { scheme: "file", pattern: "**/bin/*" }, // programs, whose heads and launch files are checked
    ],
    synchronize: { fileEvents: vscode.workspace.createFileSystemWatcher("**/*.{launch,xml,test,yaml,yml}") },
  });
  context.subscriptions.push(
    vscode.commands.registerCommand("ur.graph", (uri?: string) => run(command, "graph", uri)),
    vscode.commands.registerCommand("ur.launch", (uri?: string) => run(command, "launch", uri)),
  );
  await client.start();
}

export async function deactivate(): Promise<void> {
  await client?.stop();
}

function run(command: string, verb: string, uri?: string): void {
  const file = uri === undefined ? vscode.window.activeTextEditor?.document.uri : vscode.Uri.parse(uri);
  if (file === undefined) return;
  // Arguments, not a line for a shell: a path may hold anything.
  vscode.window.createTerminal({ name: `ur ${verb}`, shellPath: command, shellArgs: [verb, file.fsPath] }).show();
}
