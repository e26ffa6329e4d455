// The page of duplicates of `canonform serve`: groups of files that hold one shape, to compare and to mark.
//
// marks.js       marks and downloads
// comparison.js  two members beside each other
//
// Stable names, for tests and other scripts:
//   #duplicates           data-state: `busy`, `ready` or `failed`; #told #progress #error #retry
//   #which #sort #fold #suggest #clear #as-csv #marked  groups to show, marks of all, the download, what is marked
//   #groups li.group[data-id of the keeper]  details with ul.tiles of button.tile[data-id][data-kind], aria-pressed while compared
//     button.mark[data-mark=keep|spare], aria-pressed; #more shows further groups
//   #overlay #other       the comparison of comparison.js, in the group of its shapes; the file on its left
//   the address           /duplicates?a=ID&b=ID, the two files that are compared
// Texts from outside are set as text, never as HTML.
import { Comparison, ask, byId, fault, number } from './comparison.js';
import { Marks, filesOf } from './marks.js';
import { folderOf, tile } from './shapes.js';

const PAGE = 30;
const AGAIN = 700;

const marks = new Marks();
let report = null;
let shown = 0;
let isFolded = false;

const count = (n, what) => `${n.toLocaleString('en')} ${what}${n === 1 ? '' : 's'}`;

function size(bytes) {
  const power = Math.min(Math.floor(Math.log10(Math.max(bytes, 1)) / 3), 3);
  return `${number(bytes / 1000 ** power)} ${['bytes', 'kB', 'MB', 'GB'][power]}`;
}

// Size of the file, lengths of its box, and the day of its last change.
function facts({ bytes, size: box, modified, vertices }) {
  const day = (seconds) => new Date(1000 * seconds).toISOString().slice(0, 10);
  return [
    bytes !== null && size(bytes), box && box.map((x) => number(x)).join(' × '),
    vertices !== null && count(vertices, 'vertice').replace(/vertice$/, 'vertex'), modified !== null && day(modified),
  ].filter(Boolean).join(', ');
}

const spareBytes = (files) => files.reduce((sum, { bytes }) => sum + (bytes ?? 0), 0);

const comparison = new Comparison(() => {
  const card = document.querySelector('.tile[aria-pressed=true]');
  go(null);
  card?.focus();
});

// Keeps the address, so that a comparison can be reloaded and shared.
function go(pair) {
  history.pushState(null, '', pair ? `/duplicates?${new URLSearchParams(pair)}` : '/duplicates');
  follow();
}

function follow() {
  const given = new URLSearchParams(location.search);
  const [a, b] = [given.get('a'), given.get('b')];
  const at = report.groups.findIndex((group) => {
    const ids = filesOf(group).map(({ id }) => id);
    return ids.includes(a) && ids.includes(b);
  });
  for (const card of document.querySelectorAll('#groups .tile')) {
    card.setAttribute('aria-pressed', String(at >= 0 && card.dataset.id === b));
  }
  if (at < 0) {
    comparison.hide();
    return;
  }
  if (byId('which').value !== 'all') {
    byId('which').value = 'all';
    list();
  }
  while (!section(report.groups[at])) more();
  // The picture is beside the files that it shows.
  const shownGroup = section(report.groups[at]);
  shownGroup.firstChild.open = true;
  shownGroup.append(byId('overlay'));
  const others = filesOf(report.groups[at]).map(({ id }) => id).filter((id) => id !== b);
  byId('other').replaceChildren(...others.map((id) => new Option(id, id, id === a, id === a)));
  comparison.show(a, b, new URLSearchParams({ a, b }));
}

const section = ({ keeper }) => [...document.querySelectorAll('#groups .group')].find(({ dataset }) => dataset.id === keeper.id);

// A file: its picture, what it is, and buttons to mark it.
function card(file, keeper, first) {
  const { id, relation } = file;
  // The names are on the cards.
  const change = relation?.text.split(`${id} is ${keeper} `).at(-1);
  const told = relation
    ? [['kind', `${relation.brief} (${Math.round(100 * relation.confidence)} % certain)`], ['more', `${change}; ${relation.because.text}`]]
    : [['kind', `Suggested to keep: ${file.why}`]];
  const lines = [...(folderOf(id) ? [['more', folderOf(id)]] : []), ['more', facts(file)], ...told];
  const compared = () => go(relation ? { a: keeper, b: id } : { a: first, b: keeper });
  const item = tile(id, '', lines, `Compare ${id} with ${relation ? keeper : first}`, compared);
  item.firstChild.dataset.kind = relation?.kind ?? '';
  const buttons = item.appendChild(document.createElement('p'));
  buttons.className = 'marks';
  for (const [mark, text] of [['keep', 'Keep'], ['spare', 'Spare']]) {
    const button = buttons.appendChild(document.createElement('button'));
    Object.assign(button, { type: 'button', className: 'mark', textContent: text });
    button.dataset.mark = mark;
    button.setAttribute('aria-label', `${text} ${id}`);
    button.addEventListener('click', () => {
      marks.set(file, marks.of(file) === mark ? undefined : mark);
      showMarks();
    });
  }
  item.file = file;
  return item;
}

function groupItem(group) {
  const files = filesOf(group);
  const item = document.createElement('li');
  item.className = 'group';
  item.dataset.id = group.keeper.id;
  const folded = item.appendChild(document.createElement('details'));
  folded.open = !isFolded;
  const heading = folded.appendChild(document.createElement('summary')).appendChild(document.createElement('h2'));
  heading.textContent = `${count(files.length, 'file')} of one shape, ${size(spareBytes(group.members))} to spare`;
  const list = folded.appendChild(document.createElement('ul'));
  list.className = 'tiles';
  list.append(...files.map((file) => card(file, group.keeper.id, group.members[0].id)));
  return item;
}

const orders = {
  found: () => 0,
  bytes: (a, b) => spareBytes(b.members) - spareBytes(a.members),
  files: (a, b) => b.members.length - a.members.length,
  name: (a, b) => a.keeper.id.localeCompare(b.keeper.id, 'en', { numeric: true }),
};

const wanted = () => report.groups.filter((group) =>
  byId('which').value === 'all' || filesOf(group).every((file) => !marks.of(file))).sort(orders[byId('sort').value]);

function more() {
  const groups = wanted();
  byId('groups').append(...groups.slice(shown, shown + PAGE).map(groupItem));
  shown = Math.min(shown + PAGE, groups.length);
  byId('more').hidden = shown === groups.length;
  showMarks();
}

function list() {
  byId('duplicates').append(byId('overlay'));
  byId('groups').replaceChildren();
  shown = 0;
  more();
}

// Marks on the cards, and what they come to.
function showMarks() {
  for (const { file, lastChild } of document.querySelectorAll('#groups .tiles > li')) {
    for (const button of lastChild.children) {
      button.setAttribute('aria-pressed', String(marks.of(file) === button.dataset.mark));
    }
  }
  const groups = report.groups.map(filesOf);
  const spare = groups.flat().filter((file) => marks.of(file) === 'spare');
  const lost = groups.filter((files) => files.every((file) => marks.of(file) === 'spare'));
  const words = [`${count(spare.length, 'file')} marked as spare, ${size(spareBytes(spare))}.`];
  if (lost.length > 0) {
    words.push(`Of ${count(lost.length, 'group')} nothing would be left: ${lost.map(([{ id }]) => id).join(', ')}.`);
  }
  byId('marked').textContent = words.join(' ');
  byId('marked').dataset.lost = lost.length;
}

function suggest(mark) {
  for (const file of report.groups.flatMap(filesOf)) marks.set(file, mark(file));
  showMarks();
}

const isExact = ({ relation }) => ['identical-file', 'identical-geometry'].includes(relation?.kind);

function download(name, text) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([text], { type: 'text/plain' }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

function show() {
  const { groups, n_shapes: n, unread } = report;
  const members = groups.flatMap(({ members: all }) => all);
  byId('told').textContent = groups.length === 0
    ? `No duplicates among ${count(n, 'shape')}.`
    : `${members.length.toLocaleString('en')} of ${count(n, 'shape')} can be spared: ${count(groups.length, 'group')} of files of one shape, `
      + `${size(spareBytes(members))} without those to keep. Press a file to compare it.`;
  byId('unread').textContent = unread.length > 0
    ? `${count(unread.length, 'file')} could not be read, or changed since the index was built: ${unread.join(', ')}.` : '';
  byId('tools').hidden = groups.length === 0;
  list();
  byId('duplicates').dataset.state = 'ready';
  follow();
}

// The search outlasts a request: it is asked for until it is done. It ends when nobody asks.
async function search() {
  byId('error').textContent = '';
  byId('retry').hidden = true;
  byId('progress').hidden = false;
  byId('duplicates').dataset.state = 'busy';
  byId('told').textContent = 'Searching for duplicates…';
  for (;;) {
    const answer = await ask('/api/duplicates');
    if (answer.error) {
      byId('duplicates').dataset.state = 'failed';
      byId('told').textContent = '';
      byId('error').textContent = fault(answer);
      byId('retry').hidden = false;
    }
    byId('progress').hidden = answer.stage === undefined;
    if (answer.groups) {
      report = answer;
      show();
    }
    if (answer.stage === undefined) return;
    byId('progress').max = Math.max(answer.total, 1);
    byId('progress').value = answer.done;
    byId('told').textContent = `Searching for duplicates: ${answer.stage || 'starting'}, ${answer.done} of ${answer.total}…`;
    await new Promise((done) => { setTimeout(done, AGAIN); });
  }
}

// Which of the others is on the left.
const choice = document.createElement('label');
choice.append('Compared with ', Object.assign(document.createElement('select'), { id: 'other' }));
byId('overlay-shown').before(choice);
choice.addEventListener('change', () => go({ a: byId('other').value, b: byId('overlay').dataset.id }));
document.querySelector('input[name=shown][value=beside]').checked = true;

addEventListener('popstate', () => { if (report) follow(); });
byId('search-hit').addEventListener('click', () => {
  location.href = `/?${new URLSearchParams({ shape: byId('overlay').dataset.id })}`;
});
for (const id of ['which', 'sort']) byId(id).addEventListener('change', list);
byId('fold').addEventListener('click', () => {
  isFolded = !isFolded;
  byId('fold').textContent = isFolded ? 'Unfold all groups' : 'Fold all groups';
  for (const { firstChild } of byId('groups').children) firstChild.open = !isFolded;
});
byId('more').addEventListener('click', more);
byId('suggest').addEventListener('click', () => suggest((file) => {
  if (file.why) return 'keep';
  return isExact(file) ? 'spare' : marks.of(file);
}));
byId('clear').addEventListener('click', () => suggest(() => undefined));
byId('as-csv').addEventListener('click', () => download('duplicates.csv', marks.csv(report.groups)));
byId('retry').addEventListener('click', search);
await search();
