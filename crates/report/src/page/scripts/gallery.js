// Figure 1 in 3D: one shape and its canonical form.
//
// For programs that drive the page: #figure1-shape and #figure1-color are selects, #figure1-view-shape and
// #figure1-view-form are 3D views.
'use strict';

(() => {
  const root = document.getElementById('figure1-explorer');
  if (!root) return;
  const [shape, color, left, right] = ['shape', 'color', 'view-shape', 'view-form'].map((name) => document.getElementById(`figure1-${name}`));
  let views;

  function show() {
    const [surface, form] = surfaces.pair(Number(shape.value), root.dataset.method, color.value);
    const [first, second] = [{ title: shape.selectedOptions[0].text }, { title: 'its canonical form' }];
    if (views) {
      views[0].update(surface, first);
      views[1].update(form, second);
    } else {
      const view = canonform.view(left, surface, first);
      views = [view, canonform.view(right, form, { ...second, linkedWith: view })];
    }
  }

  for (const control of [shape, color]) control.addEventListener('change', show);
  plots.whenNear(root.querySelector('.views'), show);
})();
