// Shapes and their canonical forms in 3D: in every .gallery, a choice of the shape, and linked views of it and its forms.
//
// For programs that drive the page: .shape and .color are selects, .view are 3D views (see viewer.js for data-state).
'use strict';

for (const root of document.querySelectorAll('.gallery')) {
  const groups = JSON.parse(document.getElementById(root.dataset.source).textContent);
  const [shape, color, place] = ['.shape', '.color', '.views'].map((css) => root.querySelector(css));
  groups.forEach(({ name }, i) => shape.add(new Option(name, i)));
  const handles = [];
  // Empty views keep their place, so that nothing below moves when they are drawn.
  const added = () => {
    const view = place.appendChild(document.createElement('div'));
    view.className = 'view';
    return view;
  };
  const places = groups[0].views.map(added);

  const show = () => {
    const group = groups[shape.value];
    group.views.forEach(({ title, surface }, i) => {
      const { positions, faces } = surface;
      const shown = color.value === 'distance' && surface.values ? surface : { positions, faces, color: group.color };
      if (handles[i]) {
        handles[i].update(shown, { title });
        return;
      }
      handles.push(canonform.view(places[i] ?? added(), shown, { title, linkedWith: handles[0] }));
    });
  };

  for (const control of [shape, color]) control.addEventListener('change', show);
  root.hidden = false;
  // Drawn when it comes near the window.
  new IntersectionObserver((entries, observer) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    observer.disconnect();
    show();
  }, { rootMargin: '600px' }).observe(root);
}
