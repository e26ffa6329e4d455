// Runs before plotly, which reads canvases back: the text it measures, and after every frame of a scene the pixels
// under the pointer. Browsers warn about both. The first is announced here; the second, which no view uses, is left
// out. (Chromium without a graphics card reads every WebGL frame back itself and reports "GPU stall due to ReadPixels"
// on any page.)
(() => {
  'use strict';
  const getContext = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (kind, options) {
    if (kind === '2d') return getContext.call(this, kind, { willReadFrequently: true, ...options });
    const context = getContext.call(this, kind, options);
    if (context && kind.startsWith('webgl')) context.readPixels = () => {};
    return context;
  };
})();
