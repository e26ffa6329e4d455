// The list of the shapes of the index, filtered while typing.

const PAGE = 60;

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
  image.src = `/api/shapes/${encodeURIComponent(id)}/thumbnail`;
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
  constructor(picked) {
    this.picked = picked;
    this.list = document.getElementById('shapes');
    this.more = document.getElementById('more');
    this.count = document.getElementById('shapes-count');
    const filter = document.getElementById('filter');
    let waiting;
    filter.addEventListener('input', () => {
      clearTimeout(waiting);
      waiting = setTimeout(() => this.search(filter.value), 200);
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
