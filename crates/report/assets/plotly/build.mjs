// Builds plotly.js.gz and LICENSES, see README.md. Run it with `make plotly`; it needs Node 20 and npm.
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

const VERSION = '3.0.1';
const TRACES = ['heatmap', 'mesh3d']; // The core of plotly.js contains `scatter`.
const HEADER = `/**
* plotly.js v${VERSION}
* Copyright 2012-2025, Plotly, Inc.
* All rights reserved.
* Licensed under the MIT license
*/
`;
// The tools that plotly's esbuild-config.js loads, and the day up to which npm takes releases of dependencies.
const TOOLS = ['esbuild@0.23.1', 'esbuild-plugin-glsl@1.2.2', 'esbuild-plugin-environment@0.4.0'];
const BEFORE = '2025-06-01';

const save = (name, content) => writeFileSync(fileURLToPath(new URL(name, import.meta.url)), content);

// The licence of a package as a section of LICENSES.
function licence(folder) {
  const { name, version, license } = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
  const file = readdirSync(folder).find((file) => /^licen[cs]e/i.test(file));
  const text = file ? readFileSync(join(folder, file), 'utf8').replaceAll('\r', '').trim() : '(no licence file in the package)';
  return `== ${name} ${version}: ${license}\n\n${text}\n`;
}

const folder = mkdtempSync(join(tmpdir(), 'plotly-'));
process.chdir(folder);
try {
  writeFileSync('package.json', '{ "private": true }');
  const options = ['--no-audit', '--no-fund', '--ignore-scripts', `--before=${BEFORE}`];
  execFileSync('npm', ['install', ...options, `plotly.js@${VERSION}`, ...TOOLS], { stdio: 'inherit' });

  const require = createRequire(join(folder, 'package.json'));
  const parts = TRACES.map((trace) => `require('plotly.js/lib/${trace}')`);
  writeFileSync('entry.js', `module.exports = require('plotly.js/lib/core');\nmodule.exports.register([${parts}]);\n`);
  const { outputFiles, metafile } = await require('esbuild').build({
    ...require('plotly.js/esbuild-config.js'),
    entryPoints: ['entry.js'], outfile: 'plotly.js', write: false, minify: true, metafile: true, logLevel: 'warning',
  });

  const script = outputFiles.find(({ path }) => path.endsWith('.js')).text;
  const packed = gzipSync(HEADER + script, { level: 9 });
  packed[9] = 255; // The operating system in the header: unknown.
  save('plotly.js.gz', packed);

  const { inputs } = Object.entries(metafile.outputs).find(([path]) => path.endsWith('.js'))[1];
  const packages = Object.keys(inputs).map((path) => path.match(/^(node_modules\/(@[^/]+\/)?[^/]+)/)?.[0]);
  save('LICENSES', [...new Set(packages)].filter(Boolean).sort().map(licence).join('\n'));
  console.log(`${createHash('sha256').update(packed).digest('hex')}  plotly.js.gz (${packed.length} bytes)`);
} finally {
  rmSync(folder, { recursive: true });
}
