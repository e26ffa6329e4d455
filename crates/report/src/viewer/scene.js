// Unpacks the scripts and the surface of the page, and draws the surface. The page is transparent until it is drawn, so
// that what lies behind it is seen where scripts or WebGL are missing. A page without scripts asks the page around it for
// them; the policy allows no others.
'use strict';

(async () => {
  const asked = (resolve) => {
    const ask = () => parent.postMessage({ canonform: 'scripts' }, '*');
    const timer = setInterval(ask, 500);
    addEventListener('message', ({ data }) => {
      if (typeof data?.canonform !== 'string' || data.canonform === 'scripts') return;
      clearInterval(timer);
      resolve(data.canonform);
    });
    ask();
  };
  if (!document.getElementById('plotly')) document.body.insertAdjacentHTML('beforeend', await new Promise(asked));
  const unpacked = async (id) => {
    const bytes = Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
    return new Response(stream).text();
  };
  for (const id of ['prelude', 'plotly', 'viewer']) {
    const script = document.createElement('script');
    script.textContent = await unpacked(id);
    document.head.append(script);
  }
  const element = document.getElementById('view');
  const cover = () => {
    if (element.dataset.state === 'ready') document.body.style.background = canonform.theme().page;
  };
  new MutationObserver(cover).observe(element, { attributes: true });
  canonform.view(element, JSON.parse(await unpacked('scene')));
})();
