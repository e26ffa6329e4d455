// The page of `canonform serve`: searches with a dropped mesh or a shape of the index, and shows the results.
//
// app.js      connects queries and results
// ask.js      drop zone, file button, upload with its progress
// shapes.js   list of the shapes of the index
// answer.js   results: class, views, nearest shapes, overlay
//
// Stable names, for tests and other scripts:
//   #file #drop              file input (the files of one mesh); drop zone, class `over` while dragged over
//   #progress #status #error progress bar; current activity; error, worded as on the command line
//   #filter #shapes #more    search field, list of shapes, button to show more; #shapes-count
//     #shapes button.tile[data-id][data-label], aria-pressed on the query
//   #answer                  data-state: `empty`, `busy`, `ready` or `failed`; data-query: name of the query
//     #query-name #predicted[data-label] #facts #repaired (li: one line per repair)
//     #mesh-view #form-view  viewers with linked cameras; data-state from viewer.js
//     #results button.tile[data-id][data-label][data-distance], aria-pressed on the one in the overlay
//     #overlay               data-state: `busy`, `ready` or `failed`; data-id of the shape
//       #overlay-title #overlay-kind[data-kind] #overlay-facts #overlay-view, input[name=shown] (both, first, second)
// Texts from outside are set as text, never as HTML.
import { Ask } from './ask.js';
import { Shapes } from './shapes.js';
import { Answer } from './answer.js';

const answer = new Answer();
const shapes = new Shapes((id) => ask.withShape(id));
const ask = new Ask({
  begin(name) { answer.begin(name); shapes.mark(null); },
  answer(found) { answer.show(found); if (!found.query_id) shapes.mark(found.query); },
  failed() { answer.fail(); },
});

const health = await (await fetch('/healthz')).json();
document.getElementById('index-size').textContent = health.shapes === 1 ? '1 shape in the index.' : `${health.shapes} shapes in the index.`;
ask.limit(health);
await shapes.search('');
