"""Tries the installed Python package, without anything but NumPy."""

import pickle
import sys

import canonform

cat = canonform.datasets.generate("cat", poses=1, n_vertices=1000)[0].surface()
assert pickle.loads(pickle.dumps(cat)).distances(0).shape == (1000,)
assert cat.canonical_form(30).points.shape == (1000, 3)
assert "srcdoc" in cat.view()._repr_html_()
print("canonform", canonform.__version__, "works in Python", sys.version.split()[0])
