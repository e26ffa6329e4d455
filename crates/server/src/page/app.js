// The page of `canonform serve`. Asks with a dropped mesh or with a shape of the index, shows the answer.
//
// app.js      what belongs together: asking, the answer, errors
// ask.js      drop zone, file button, upload with its progress
// shapes.js   the list of the index
// answer.js   the answer: verdict, views, nearest shapes, overlay
//
// Names that do not change, for tests and other scripts:
//   #file #drop              file input (the files of one mesh); drop zone, class `over` while dragged over
//   #progress #status #error progress bar; what is going on; what went wrong, in the words of the command line
//   #filter #shapes #more    search field, list of the index, button for more of it; #shapes-count
//     #shapes button.tile[data-id][data-label], aria-pressed on the one that was asked with
//   #answer                  data-state: `empty`, `busy`, `ready` or `failed`; data-query: name of what was asked with
//     #query-name #predicted[data-label] #facts #repaired (li: a line a repair)
//     #mesh-view #form-view  viewers with linked cameras; data-state from viewer.js
//     #results button.tile[data-id][data-label][data-distance], aria-pressed on the one that is laid over
//     #overlay               data-state: `busy`, `ready` or `failed`; data-id of the shape
//       #overlay-title #overlay-kind[data-kind] #overlay-facts #overlay-view, input[name=shown] (both, first, second)
// All texts from outside are set as text, never as HTML.
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
document.getElementById('index-size').textContent = `Among ${health.shapes} shapes.`;
ask.limit(health);
await shapes.search('');
