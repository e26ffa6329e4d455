// Before plotly's script, which reads canvases back: the letters it sets, and after every frame of a scene what might
// lie under the pointer. Browsers warn of both. So the first is announced, and the second, which no view here asks
// for, is left out. (Chromium without a graphics card reads every WebGL picture back itself and says "GPU stall due to
// ReadPixels" on any page; that is not ours to mend.)
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
