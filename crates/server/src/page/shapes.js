// Tiles of shapes, and the list of the index, filtered while typing.

const PAGE = 60;

// A busy server refuses pictures too; they are asked for again after these milliseconds.
const AGAIN = [2000, 5000, 15000];

// A name has folders in front of it, separated by slashes.
export const folderOf = (id) => id.slice(0, Math.max(id.lastIndexOf('/'), 0));
export const nameOf = (id) => id.slice(id.lastIndexOf('/') + 1);

// The innermost folder that all names have in common; empty if there is none.
export function commonFolder(ids) {
  const [first = [], ...others] = ids.map((id) => folderOf(id).split('/'));
  const differs = (part, i) => others.some((parts) => parts[i] !== part);
  const end = first.findIndex(differs);
  return (end < 0 ? first : first.slice(0, end)).join('/');
}

// A button with a thumbnail, of a size that does not depend on the image. `lines` are [class, text]; `about` is the
// full text, shown on hover.
export function tile(id, label, lines, about, pressed) {
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
  for (const [kind, text] of [['name', nameOf(id)], ...lines]) {
    const line = button.appendChild(document.createElement('span'));
    line.className = kind;
    line.textContent = text;
  }
  button.title = about;
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
    this.more.addEventListener('click', () => this.load(this.list.querySelectorAll('.tile').length));
  }

  // Each folder is named once, above its shapes.
  append({ id, label }) {
    const folder = folderOf(id);
    if (folder !== this.folder) {
      this.folder = folder;
      const heading = this.list.appendChild(document.createElement('li'));
      heading.className = 'folder';
      heading.textContent = folder || 'No folder';
    }
    const lines = label && label !== folder ? [['more', label]] : [];
    this.list.append(tile(id, label, lines, label ? `${id}, ${label}` : id, this.picked));
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
    if (offset === 0) {
      this.list.replaceChildren();
      this.folder = '';
    }
    for (const shape of shapes) this.append(shape);
    this.more.hidden = offset + shapes.length >= total;
    this.count.textContent = total === 1 ? '1 shape' : `${total} shapes`;
    mark(this.list, this.asked);
  }

  mark(id) {
    this.asked = id;
    mark(this.list, id);
  }
}
