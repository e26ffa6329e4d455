// The page of `canonform serve`: searches with a dropped mesh or a shape of the index, and shows the results.
//
// app.js      follows the address of the page
// state.js    what the address says
// ask.js      drop zone, file button, requests with their progress
// shapes.js   tiles, list of the shapes of the index
// answer.js   results: class, views, nearest shapes
// comparison.js  overlay of two meshes or forms, corresponding points
//
// Stable names, for tests and other scripts:
//   #file #drop              file input (the files of one mesh); drop zone, class `over` while dragged over
//   #progress #status #error progress bar; current activity; error, worded as on the command line; #retry
//   #index-size #index-note  size of the index; whether it has changed; #search-again
//   #filter #shapes #more    search field, list of shapes, button to show more; #shapes-count
//     #shapes li.folder, button.tile[data-id][data-label], aria-pressed on the query
//   #page                    data-at: `start` or `answer`
//   #answer                  data-state: `empty`, `busy`, `ready` or `failed`; data-query: name of the query
//     #start                 shown without a query
//     #query-name #predicted[data-label] #facts #repaired (li: one line per repair)
//     #mesh-view #form-view  viewers with linked cameras; data-state from viewer.js
//     #k #rank #as-csv #as-json  number and order of results, downloads
//     #results-folder        the folder that all results have in common
//     #results button.tile[data-id][data-label][data-distance][data-kind], aria-pressed on the one in the overlay
//     #results[data-explained]  whether files and meshes were compared for the kinds; #components of the query
//     #overlay               data-state: `busy`, `ready` or `failed`; data-id of the shape; data-shown: `meshes` or `forms`
//       #overlay-title #overlay-kind[data-kind] #overlay-facts #overlay-view #overlay-second, input[name=shown] (both, beside, first, second)
//       #search-hit #close-hit  a search with the shape of the overlay; back to the results alone
//       #match-hit #match[data-state] #match-title #match-facts #match-first #match-second  corresponding points of both meshes
// Texts from outside are set as text, never as HTML.
import { Ask } from './ask.js';
import { Shapes } from './shapes.js';
import { Answer } from './answer.js';
import { address, read, sameSearch, searched } from './state.js';

const byId = (id) => document.getElementById(id);
const CHECK = 10_000;

// What the page shows; null while it shows something else, such as an error.
let shown = null;

const answer = new Answer({
  picked: (hit) => go({ ...read(), hit }),
  closed: () => go({ ...read(), hit: null }),
});
const shapes = new Shapes({
  picked: (shape) => go({ ...read(), shape, query: null, hit: null }),
  filtered: (filter) => history.replaceState(history.state, '', address({ ...read(), filter })),
});
const ask = new Ask({
  begin(name) { shown = null; answer.begin(name); shapes.mark(null); title(name); },
  answer(found) {
    const { k, rank, filter, hit, query } = read();
    const state = { k, rank, filter };
    if (found.query_id) Object.assign(state, { query: found.query_id });
    else Object.assign(state, { shape: found.query });
    // An upload gets its address here; the other searches have theirs.
    if (found.query_id && found.query_id !== query) {
      history.pushState({ name: found.query }, '', address(state));
    } else {
      state.hit = hit;
    }
    shown = { ...state, hit: null };
    answer.show(found, state);
    if (state.shape) shapes.mark(state.shape);
    title(found.query);
    overlay();
  },
  failed() { answer.fail(); title(null); },
});

// Shows another state.
function go(state) {
  if (address(state) === address(read())) return;
  history.pushState(state.query === read().query ? history.state : null, '', address(state));
  follow();
}

// Shows what the address says.
function follow() {
  const state = read();
  answer.controls(state);
  if (!state.shape && !state.query) {
    ask.stop();
    shown = state;
    answer.clear();
    shapes.mark(null);
    title(null);
  } else if (sameSearch(shown, state)) {
    overlay();
  } else {
    const name = state.shape ?? history.state?.name ?? 'an earlier upload';
    ask.again(`/api/search?${searched(state)}`, name);
  }
}

// The overlay follows the address without another search.
function overlay() {
  const { hit } = read();
  if (hit && hit !== shown.hit) answer.compare(hit);
  if (!hit) answer.uncompare();
  shown.hit = hit;
}

function title(name) {
  document.title = name ? `${name} – canonform` : 'canonform: shape search';
}

addEventListener('popstate', follow);
byId('k').addEventListener('change', () => go({ ...read(), k: Number(byId('k').value) }));
byId('rank').addEventListener('change', () => go({ ...read(), rank: byId('rank').value }));
byId('home').addEventListener('click', (event) => {
  if (event.ctrlKey || event.metaKey || event.shiftKey) return;
  event.preventDefault();
  const { k, rank } = read();
  go({ k, rank });
});
byId('search-hit').addEventListener('click', () => go({ ...read(), shape: read().hit, query: null, hit: null }));
byId('search-again').addEventListener('click', () => {
  byId('search-again').hidden = true;
  byId('index-note').textContent = '';
  shown = null;
  follow();
});

// The server opens the index again when it changes; then the lists are old, and maybe the results.
let version = null;
async function check() {
  const note = byId('index-note');
  let health;
  try {
    health = await (await fetch('/healthz')).json();
  } catch {
    note.textContent = 'The server does not respond.';
    return;
  }
  const { shapes: count, index } = health;
  byId('index-size').textContent = count === 1 ? '1 shape in the index.' : `${count} shapes in the index.`;
  ask.limit(health);
  if (index.version === version) {
    const state = { missing: 'The file of the index is missing.', unreadable: 'The file of the index has changed and cannot be read.' }[index.state];
    if (state) note.textContent = `${state} Searches use the index as it was opened.`;
    else if (byId('search-again').hidden) note.textContent = '';
    return;
  }
  if (version !== null) {
    note.textContent = 'The index has changed.';
    byId('search-again').hidden = !(read().shape || read().query);
  }
  version = index.version;
  await shapes.search(byId('filter').value);
}
setInterval(() => { if (!document.hidden) check(); }, CHECK);
document.addEventListener('visibilitychange', () => { if (!document.hidden) check(); });

byId('filter').value = read().filter;
follow();
await check();
