// What is marked as to keep or to spare, in this browser only, and what can be downloaded of it.

const STORE = 'canonform.marks';

// A file of the report with its role in its group, and the hash of its content.
export function filesOf({ keeper, why, members }) {
  const content = (i) => members[i === 0 ? 0 : i - 1].relation.because.content[i === 0 ? 0 : 1];
  return [keeper, ...members].map((file, i) => ({ ...file, why: i === 0 ? why : undefined, content: content(i) }));
}

export class Marks {
  constructor() {
    try {
      this.all = JSON.parse(localStorage.getItem(STORE)) ?? {};
    } catch {
      this.all = {};
    }
  }

  // `keep`, `spare` or nothing. A file whose content has changed has lost its mark.
  of({ id, content }) {
    const known = Object.hasOwn(this.all, id) ? this.all[id] : {};
    return known.content === content ? known.mark : undefined;
  }

  set({ id, content }, mark) {
    if (mark) this.all[id] = { mark, content };
    else delete this.all[id];
    try {
      localStorage.setItem(STORE, JSON.stringify(this.all));
    } catch {
      // Without storage, marks last until the page is left.
    }
  }

  csv(groups) {
    // An apostrophe keeps a spreadsheet from taking a name for a formula.
    const plain = (value) => (/^[=+\-@\t\r\n＝＋－＠]/.test(value) ? `'${value}` : value);
    const quoted = (value) => (/[",;\t\r\n]/.test(value) ? `"${value.replaceAll('"', '""')}"` : value);
    const cell = (value) => quoted(plain(value));
    const line = (...cells) => `${cells.map((value) => cell(String(value ?? ''))).join(',')}\r\n`;
    const lines = groups.flatMap((group, i) => filesOf(group).map((file) => {
      const { kind, confidence, text } = file.relation ?? {};
      return line(i + 1, this.of(file), file.id, file.path, kind, confidence, text ?? file.why, file.bytes, file.modified);
    }));
    return line('group', 'mark', 'id', 'path', 'kind', 'confidence', 'relation', 'bytes', 'modified') + lines.join('');
  }
}
