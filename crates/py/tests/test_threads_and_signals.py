"""Ctrl-C, the GIL, threads and forked processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import canonform
import numpy as np
import pytest
from canonform import Surface
from conftest import grid

LONG = """
import canonform, numpy as np, sys, time
x, y = np.meshgrid(np.arange(150.0), np.arange(150.0), indexing="ij")
i = np.arange(150 * 150).reshape(150, 150)
a, b, c, d = i[:-1, :-1].ravel(), i[1:, :-1].ravel(), i[1:, 1:].ravel(), i[:-1, 1:].ravel()
surface = canonform.Surface(
    np.column_stack([x.ravel(), y.ravel(), np.sin(x.ravel() / 9)]),
    np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]),
)
small = surface.distances([0])
print("ready", flush=True)
start = time.monotonic()
try:
    CALL
except KeyboardInterrupt:
    print("interrupted", flush=True)
# The surface is as good as before.
assert np.array_equal(surface.distances([0]), small)
print("usable", flush=True)
"""


def interrupted(call: str) -> float:
    """Runs a long call, presses Ctrl-C, and returns the seconds until it ended."""
    code = textwrap.dedent(LONG).replace("CALL", call)
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.5)
        pressed = time.monotonic()
        process.send_signal(signal.SIGINT)
        assert process.stdout.readline() == "interrupted\n"
        seconds = time.monotonic() - pressed
        assert process.stdout.readline() == "usable\n"
        assert process.wait(60) == 0
    return seconds


@pytest.mark.skipif(os.name == "nt", reason="no SIGINT for one process")
@pytest.mark.parametrize(
    "call",
    [
        "surface.distances_many(range(4000))",
        pytest.param("surface.distances_many(range(4000), geodesic='exact')", marks=pytest.mark.slow),
        pytest.param("surface.canonical_form(n_landmarks=5000)", marks=pytest.mark.slow),
        pytest.param("surface.farthest_points(20000, geodesic='exact')", marks=pytest.mark.slow),
        pytest.param("surface.signature(n_landmarks=5000)", marks=pytest.mark.slow),
        pytest.param("surface.distance_field(5000)", marks=pytest.mark.slow),
        pytest.param("surface.eigenbasis(1000)", marks=pytest.mark.slow),
        "canonform.match(surface, surface, n_eigenfunctions=1000)",
        pytest.param("canonform.compare(surface, surface, n_landmarks=5000)", marks=pytest.mark.slow),
        pytest.param("canonform.datasets.generate(n_vertices=20_000, poses=6)", marks=pytest.mark.slow),
        pytest.param("canonform.datasets.generate('cat', n_vertices=100_000)", marks=pytest.mark.slow),
        pytest.param("canonform.datasets.generate('spider', n_vertices=100_000)", marks=pytest.mark.slow),
        pytest.param("canonform.datasets.generate('person', n_vertices=1_000_000)", marks=pytest.mark.slow),
    ],
)
def test_control_c_interrupts(call: str) -> None:
    # Times are told and not asserted: a machine may be busy.
    print(f"{call}: {interrupted(call):.2f} s")


def test_a_handler_that_does_not_raise_does_not_interrupt(square: Surface) -> None:
    seen = []
    before = signal.signal(signal.SIGINT, lambda *_: seen.append(1))
    try:
        timer = threading.Timer(0.1, signal.raise_signal, [signal.SIGINT])
        timer.start()
        large = Surface(*grid(45))
        assert np.isfinite(large.distances_many(range(2025), geodesic="exact")).all()
        timer.join()
    finally:
        signal.signal(signal.SIGINT, before)
    assert seen == [1]


def test_other_threads_run_while_distances_are_measured() -> None:
    surface = Surface(*grid(80))
    surface.distances(0)
    counted, done = 0, threading.Event()
    worker = threading.Thread(target=lambda: (surface.distances_many(range(1500)), done.set()))
    worker.start()
    while not done.is_set():
        counted += 1
        time.sleep(0.001)
    worker.join()
    assert counted > 5, "the GIL is held"


def test_one_surface_serves_many_threads() -> None:
    surface, sources = Surface(*grid(30)), list(range(0, 900, 9))
    expected = [surface.distances(source, geodesic="heat") for source in sources]
    fresh = Surface(*grid(30))
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda source: fresh.distances(source, geodesic="heat"), sources))
    np.testing.assert_array_equal(found, expected)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_forked_process_has_threads_of_its_own(square: Surface) -> None:
    # multiprocessing forks on Linux by default before Python 3.14; the threads of the parent are not there.
    code = """
        import os, canonform
        shape = canonform.datasets.generate("cat", poses=1, n_vertices=1000)[0]
        expected = shape.surface().canonical_form(n_landmarks=20).points
        canonform.set_threads(3)
        child = os.fork()
        if child == 0:
            os._exit(0 if canonform.threads() == 3 and (shape.surface().canonical_form(n_landmarks=20).points == expected).all() else 1)
        assert os.waitpid(child, 0)[1] == 0
        assert (shape.surface().canonical_form(n_landmarks=20).points == expected).all()
    """
    subprocess.run([sys.executable, "-W", "ignore", "-c", textwrap.dedent(code)], check=True, timeout=60)


@pytest.mark.parametrize(
    ("variables", "n"),
    [
        ({"OMP_NUM_THREADS": "3"}, 3),
        ({"OMP_NUM_THREADS": "3", "RAYON_NUM_THREADS": "2"}, 2),
        # As `set_threads` of the parent says, which workers of joblib inherit.
        ({"OMP_NUM_THREADS": "3", "CANONFORM_NUM_THREADS": "4"}, 4),
        ({"OMP_NUM_THREADS": "4,2"}, os.cpu_count()),
    ],
)
def test_the_environment_says_how_many_threads(variables: dict[str, str], n: int) -> None:
    others = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    code = "import canonform; print(canonform.threads())"
    done = subprocess.run([sys.executable, "-c", code], env={**others, **variables}, capture_output=True, text=True, check=True)
    assert int(done.stdout) == n


def test_threads_of_a_call_and_of_new_processes(square: Surface) -> None:
    before = canonform.threads()
    try:
        canonform.set_threads(3)
        assert os.environ["CANONFORM_NUM_THREADS"] == "3"
        np.testing.assert_array_equal(square.distances_many([0, 1], threads=1), square.distances_many([0, 1]))
        assert canonform.threads() == 3
    finally:
        canonform.set_threads(before)


def test_a_limit_ends_a_call_and_keeps_the_surface() -> None:
    large = Surface(*grid(60))
    expected = large.distances(0, geodesic="exact")
    with pytest.raises(canonform.errors.TimeLimitError, match="timeout="):
        large.distances_many(range(3600), geodesic="exact", timeout=0.1)
    np.testing.assert_array_equal(large.distances(0, geodesic="exact", timeout=60, memory="1.5G"), expected)


def test_progress_calls_a_function_or_a_bar(capsys: pytest.CaptureFixture[str]) -> None:
    surface, seen = Surface(*grid(45)), []
    surface.distances_many(range(400), geodesic="exact", progress=lambda *step: seen.append(step))
    assert seen and {stage for stage, _, _ in seen} == {"distances"}
    assert [done for _, done, _ in seen] == sorted(done for _, done, _ in seen)
    surface.distances_many(range(400), geodesic="exact", progress=True)
    assert "distances" in capsys.readouterr().err


def test_an_exception_of_the_progress_function_ends_the_work() -> None:
    def stop(*_: object) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        Surface(*grid(45)).distances_many(range(2025), geodesic="exact", progress=stop)
    assert canonform.threads() >= 1
