// Requests: files that are dropped or chosen, a shape of the index, or an earlier upload.

const byId = (id) => document.getElementById(id);

export class Ask {
  // Calls `begin`, `answer` and `failed` of `to`; only the last query counts.
  constructor(to) {
    this.to = to;
    this.maxUpload = Infinity;
    this.question = 0;
    const [drop, file] = [byId('drop'), byId('file')];
    file.addEventListener('change', () => {
      this.withFiles([...file.files]);
      // Choosing the same file again is a new query.
      file.value = '';
    });
    let depth = 0;
    const over = (change) => {
      depth = change === 0 ? 0 : depth + change;
      drop.classList.toggle('over', depth > 0);
    };
    // A file dropped outside the zone would replace the page.
    addEventListener('dragenter', (event) => { event.preventDefault(); over(1); });
    addEventListener('dragleave', () => over(-1));
    addEventListener('dragover', (event) => event.preventDefault());
    addEventListener('drop', (event) => {
      event.preventDefault();
      over(0);
      if (event.dataTransfer.files.length > 0) this.withFiles([...event.dataTransfer.files]);
    });
    byId('upload').addEventListener('submit', (event) => event.preventDefault());
    byId('retry').addEventListener('click', () => this.send(...this.last));
  }

  limit({ max_upload: maxUpload }) {
    this.maxUpload = maxUpload;
  }

  withFiles(files) {
    if (files.length === 0) return;
    const form = new FormData();
    for (const file of files) form.append('mesh', file, file.name);
    const size = files.reduce((sum, file) => sum + file.size, 0);
    const name = files.map((file) => file.name).join(' and ');
    if (size > this.maxUpload) {
      this.begin(name);
      this.fail(`${name}: ${megabytes(size)} exceed the upload limit of ${megabytes(this.maxUpload)}; ` +
        'simplify the mesh, or raise the upload limit of the server');
      return;
    }
    const params = new URLSearchParams({ k: byId('k').value, rank: byId('rank').value });
    this.send('POST', `/api/search?${params}`, form, name);
  }

  // A search that needs no upload.
  again(address, name) {
    this.send('GET', address, null, name);
  }

  // Forgets the current query.
  stop() {
    this.question += 1;
    this.request?.abort();
    this.request = null;
    clearInterval(this.clock);
    byId('progress').hidden = true;
    byId('retry').hidden = true;
    for (const id of ['error', 'status', 'elapsed']) byId(id).textContent = '';
  }

  begin(name) {
    this.stop();
    this.to.begin(name);
    return this.question;
  }

  // XMLHttpRequest, because fetch does not report upload progress.
  send(method, address, body, name) {
    this.last = [method, address, body, name];
    const question = this.begin(name);
    const current = () => question === this.question;
    const [progress, status, elapsed] = [byId('progress'), byId('status'), byId('elapsed')];
    const request = new XMLHttpRequest();
    this.request = request;
    const start = Date.now();
    this.clock = setInterval(() => { elapsed.textContent = `${Math.round((Date.now() - start) / 1000)} s`; }, 1000);
    const measuring = () => {
      progress.removeAttribute('value');
      status.textContent = body ? `Measuring and searching with ${name}…` : `Searching with ${name}…`;
    };
    progress.hidden = false;
    progress.value = 0;
    if (body) {
      status.textContent = `Uploading ${name}…`;
      request.upload.addEventListener('progress', (event) => {
        if (current() && event.lengthComputable) progress.value = (100 * event.loaded) / event.total;
      });
      request.upload.addEventListener('load', () => { if (current()) measuring(); });
    } else {
      measuring();
    }
    request.addEventListener('loadend', () => {
      if (!current()) return;
      clearInterval(this.clock);
      elapsed.textContent = '';
      progress.hidden = true;
      const found = request.response;
      if (request.status === 200 && found) {
        status.textContent = `${name}: done.`;
        this.to.answer(found);
        return;
      }
      // Later, the same request may succeed.
      byId('retry').hidden = request.status !== 503 && request.status !== 0 && request.status !== 408;
      if (found?.error) {
        const text = found.remedy ? `${found.error}; ${found.remedy}` : found.error;
        // The error does not name an upload that the server has forgotten.
        const forgotten = request.status === 410 && history.state?.name;
        this.fail(forgotten ? `${forgotten}: ${text}` : text);
      } else {
        this.fail('The server did not respond; check that it is running, and try again.');
      }
    });
    request.responseType = 'json';
    request.open(method, address);
    request.send(body);
  }

  fail(text) {
    byId('progress').hidden = true;
    byId('status').textContent = '';
    byId('error').textContent = text;
    this.to.failed();
    byId('error').scrollIntoView({ block: 'nearest' });
  }
}

const megabytes = (bytes) => `${(bytes / 1e6).toFixed(bytes < 1e6 ? 2 : 0)} MB`;
