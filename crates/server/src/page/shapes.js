// Tiles of shapes: the list of the index, filtered while typing, and some shapes at the start.

const PAGE = 60;
const SAMPLE = 24;

// A busy server refuses pictures too; they are asked for again after these milliseconds.
const AGAIN = [2000, 5000, 15000];

// A button with a thumbnail, of a size that does not depend on the image.
export function tile(id, label, lines, pressed) {
  const button = document.createElement('button');
  button.type = 'button';
  button.className = 'tile';
  button.dataset.id = id;
  button.dataset.label = label;
  button.setAttribute('aria-pressed', 'false');
  const image = document.createElement('img');
  image.alt = '';
  image.loading = 'lazy';
  image.width = 176;
  image.height = 176;
  const address = `/api/shapes/${encodeURIComponent(id)}/thumbnail`;
  let failures = 0;
  image.addEventListener('error', () => {
    if (failures === AGAIN.length) return;
    setTimeout(() => { image.src = `${address}?try=${failures}`; }, AGAIN[failures]);
    failures += 1;
  });
  image.src = address;
  button.append(image);
  for (const [kind, text] of [['name', id], ...lines]) {
    const line = button.appendChild(document.createElement('span'));
    line.className = kind;
    line.textContent = text;
  }
  button.title = [id, ...lines.map(([, text]) => text)].join(', ');
  button.addEventListener('click', () => pressed(id));
  const item = document.createElement('li');
  item.append(button);
  return item;
}

// Marks the tile of this shape only.
export function mark(list, id) {
  for (const button of list.querySelectorAll('.tile')) {
    button.setAttribute('aria-pressed', String(button.dataset.id === id));
  }
}

export class Shapes {
  constructor({ picked, filtered }) {
    this.picked = picked;
    this.list = document.getElementById('shapes');
    this.more = document.getElementById('more');
    this.count = document.getElementById('shapes-count');
    const filter = document.getElementById('filter');
    let waiting;
    filter.addEventListener('input', () => {
      clearTimeout(waiting);
      waiting = setTimeout(() => {
        filtered(filter.value.trim());
        this.search(filter.value);
      }, 200);
    });
    this.more.addEventListener('click', () => this.load(this.list.children.length));
  }

  search(text) {
    this.text = text.trim();
    return this.load(0);
  }

  async load(offset) {
    const { text } = this;
    const params = new URLSearchParams({ offset, limit: PAGE, q: text });
    const response = await fetch(`/api/shapes?${params}`);
    // Responses to earlier input may arrive late.
    if (!response.ok || text !== this.text) return;
    const { total, shapes } = await response.json();
    const tiles = shapes.map(({ id, label }) => tile(id, label, [['more', label]], this.picked));
    if (offset === 0) this.list.replaceChildren(...tiles);
    else this.list.append(...tiles);
    this.more.hidden = offset + shapes.length >= total;
    this.count.textContent = total === 1 ? '1 shape' : `${total} shapes`;
    mark(this.list, this.asked);
  }

  mark(id) {
    this.asked = id;
    mark(this.list, id);
  }
}

// Some shapes of as many classes as possible.
export class Sample {
  constructor(picked) {
    this.picked = picked;
  }

  async load() {
    const response = await fetch(`/api/shapes?${new URLSearchParams({ sample: SAMPLE })}`);
    if (!response.ok) return;
    const { shapes } = await response.json();
    const tiles = shapes.map(({ id, label }) => tile(id, label, [['more', label]], this.picked));
    document.getElementById('sample').replaceChildren(...tiles);
  }
}
