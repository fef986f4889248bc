# SPDX-License-Identifier: MIT
"""Unusual arguments, threads, processes: exceptions, never a crash; properties of every series."""

import concurrent.futures
import ctypes
import multiprocessing
import os
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import gyroakf

FUNCTIONS = [
    gyroakf.allan,
    gyroakf.noise_fit,
    gyroakf.adf,
    gyroakf.kpss,
    gyroakf.ar,
    gyroakf.mark_outliers,
    gyroakf.identify_drift,
    gyroakf.Filter([0.5], 1, 1).run,
]
REFUSED = (TypeError, ValueError, ArithmeticError, MemoryError, gyroakf.GyroakfError)
relaxed = settings(deadline=None, max_examples=40, suppress_health_check=list(HealthCheck))


@pytest.mark.parametrize(
    "data",
    [
        None,
        1.0,
        object(),
        {"a": 1},
        [],
        [[]],
        [1, "x"],
        b"abc",
        np.array(["a", "b"]),
        np.zeros(100, complex),
        np.zeros((10, 10)),
        np.array(3.0),
        np.zeros(100, "M8[s]"),
        np.zeros(0),
        [1.0],
        [1.0, 2.0],
        np.full(100, np.nan),
        np.full(100, np.inf),
        np.zeros(100),
        np.full(100, 1e308),
        [None, None],
        range(0),
        memoryview(b"12345678"),
        np.zeros(100, [("x", float)]),
    ],
    ids=repr,
)
@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda f: getattr(f, "__qualname__", "run"))
def test_bad_series(function, data):
    try:
        function(data)
    except REFUSED:
        pass


@pytest.mark.parametrize(
    "make",
    [
        lambda x: x[::-1],
        lambda x: x[::3],
        lambda x: np.lib.stride_tricks.as_strided(x, (500,), (16,)),
        lambda x: x.astype(">f8"),
        lambda x: x.astype(np.float32),
        lambda x: x.astype(np.longdouble),
        lambda x: (x * 100).astype(np.int16),
        lambda x: x > 0,
        lambda x: np.frombuffer(b"\0" + x.tobytes(), offset=1),
        lambda x: np.ma.masked_greater(x, 2),
        lambda x: x.astype(object),
        lambda x: memoryview(x),
        lambda x: np.broadcast_to(x[:1], (1000,)) + x[:1000],
    ],
)
def test_layouts_are_converted(noise, make):
    x = make(noise)
    plain = np.array(
        x.astype(float).filled(np.nan) if isinstance(x, np.ma.MaskedArray) else x, dtype=float
    )
    try:
        expected = gyroakf.allan(plain).deviation.tolist()
    except gyroakf.GyroakfError as error:
        with pytest.raises(type(error)):
            gyroakf.allan(x)
    else:
        assert gyroakf.allan(x).deviation.tolist() == expected


def test_inputs_are_not_changed_and_may_be_read_only(noise):
    before = noise.copy()
    noise.flags.writeable = False
    for function in FUNCTIONS:
        function(noise)
    assert (noise == before).all()
    for out in (noise, np.zeros(3), np.zeros(4000)[::2], np.zeros(2000, np.float32), [0.0] * 2000):
        with pytest.raises(ValueError, match="out"):
            gyroakf.Filter([0.5], 1, 1).run(noise, out=out)


def test_sizes_beyond_memory():
    for samples in (2**44, 2**42):
        with pytest.raises(MemoryError):
            gyroakf.simulate(samples)
    for samples in (2**62, 2**63, 2**64 + 10, -1, 0):
        with pytest.raises(ValueError):
            gyroakf.simulate(samples)
    with pytest.raises(MemoryError):
        gyroakf.allan(np.broadcast_to(0.0, (2**44,)))
    for order in (2**31, 2**32 + 1, 1001, -2):
        with pytest.raises(ValueError):
            gyroakf.ar(np.arange(100.0), max_order=order)


@pytest.mark.parametrize(
    "call",
    [
        lambda x: gyroakf.allan(x, 0),
        lambda x: gyroakf.allan(x, -1),
        lambda x: gyroakf.allan(x, float("nan")),
        lambda x: gyroakf.allan(x, kind="x"),
        lambda x: gyroakf.allan(x, kind="o\0adev"),
        lambda x: gyroakf.allan(x, taus=[]),
        lambda x: gyroakf.allan(x, taus=[-1.0]),
        lambda x: gyroakf.allan(x, taus="often"),
        lambda x: gyroakf.allan(x, confidence=2),
        lambda x: gyroakf.allan(x, column="gx"),
        lambda x: gyroakf.adf(x, lags=10**6),
        lambda x: gyroakf.kpss(x, rule="?"),
        lambda x: gyroakf.ar(x, order=2000),
        lambda x: gyroakf.noise_fit(gyroakf.allan(x, kind="mdev")),
        lambda x: gyroakf.noise_fit(x, terms="XYZ"),
        lambda x: gyroakf.Filter([2.0], 1, 1),
        lambda x: gyroakf.Filter([0.5], -1, 1),
        lambda x: gyroakf.Filter([0.5], 1, 1, no_such=1),
        lambda x: gyroakf.Filter([0.5], "a", 1),
        lambda x: gyroakf.Filter([[0.5]], 1, 1),
        lambda x: gyroakf.Filter([0.5], 1, 1).step("a"),
        lambda x: gyroakf.DriftModel((1.0,) * 4, (1.0,) * 4, 1.0, (True,) * 4).filter(),
        lambda x: gyroakf.DriftModel((1.0,), (), 1.0, (True,)).smooth(x),
        lambda x: gyroakf.DriftModel((), (), 1.0, ()).filter(),
        lambda x: gyroakf.simulate(preset="?"),
        lambda x: gyroakf.simulate(seed=1.5),
        lambda x: gyroakf.run(np.zeros((2, 2, 2))),
        lambda x: gyroakf.read("a\0b"),
        lambda x: gyroakf.read(__file__, bad_lines="?"),
        lambda x: gyroakf._filters._restore(b"abc"),
    ],
)
def test_bad_arguments(noise, call):
    with pytest.raises((TypeError, ValueError, ArithmeticError)):
        call(noise)


def test_statuses_are_exceptions(tmp_path):
    with pytest.raises(OSError):
        gyroakf.read(tmp_path / "no")
    with pytest.raises(OSError):
        gyroakf.read(tmp_path)
    with pytest.raises(gyroakf.ConstantInputError):
        gyroakf.adf(np.ones(100))
    with pytest.raises(gyroakf.TooFewSamplesError):
        gyroakf.identify_drift(np.arange(20.0))
    with pytest.raises(gyroakf.NonFiniteError):
        gyroakf.allan([1, 2, float("inf")])
    with pytest.raises(gyroakf.UnstableError):
        gyroakf.Filter([1.5], 1, 1)


def test_progress_and_its_exceptions():
    seen = []
    log = gyroakf.simulate(3_000_000, n=1, progress=lambda *args: seen.append(args))
    gyroakf.allan(log, taus="log:50", progress=lambda *args: seen.append(args))
    assert seen and all(isinstance(stage, str) and 0 <= done for stage, done, _ in seen)

    def stop(*_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        gyroakf.allan(log, taus="log:200", progress=stop)
    kalman = gyroakf.Filter([0.5], 1, 1, estimate_process_variance=1)

    def stop_later(_, done, __):
        if done > 0:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        kalman.run(np.tile(log["gx"], 20), progress=stop_later)
    made = kalman.state.steps
    assert 0 < made < 60_000_000
    kalman.step(1.0)
    assert kalman.state.steps == made + 1


def test_interrupt_cancels_and_the_handler_is_back():
    log = gyroakf.simulate(2_000_000, n=1)
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        timer.start()
        gyroakf.allan(log, taus="all")  # would take hours
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    timer.join()


def test_a_filter_is_for_one_thread_at_a_time(noise):
    kalman = gyroakf.Filter([0.5], 1, 1)
    refused = []

    def meanwhile(*_):
        for call in (lambda: kalman.step(1.0), lambda: kalman.state, kalman.reset, kalman.freeze):
            with pytest.raises(RuntimeError, match="in use"):
                call()
        refused.append(True)

    while not refused:
        kalman.run(np.tile(noise, 20_000), progress=meanwhile)
    kalman.step(1.0)


def same_as_alone(seed):
    return gyroakf.allan(np.random.default_rng(seed).standard_normal(20_000)).deviation.tolist()


def test_threads_on_their_own_objects():
    alone = [same_as_alone(seed) for seed in range(16)]
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        assert np.allclose(list(pool.map(same_as_alone, range(16))), alone, rtol=1e-12)


def test_the_lock_of_python_is_released():
    looks, done = [0], threading.Event()

    def look():
        while not done.wait(0.001):
            looks[0] += 1

    x = np.tile(gyroakf.simulate(1_000_000, n=1)["gx"], 10)
    thread = threading.Thread(target=look)
    thread.start()
    most = 0
    for _ in range(50):  # one run is enough unless the machine is busy
        kalman = gyroakf.Filter([0.5], 1, 1, estimate_process_variance=1)
        before = looks[0]
        kalman.run(x)
        most = max(most, looks[0] - before)
        if most > 3:
            break
    done.set()
    thread.join()
    assert most > 3


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_pools_of_processes(method):
    alone = [same_as_alone(seed) for seed in range(4)]
    context = multiprocessing.get_context(method)
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as pool:
        assert np.allclose(list(pool.map(same_as_alone, range(4), timeout=100)), alone, rtol=1e-12)


def test_many_handles_come_and_go():
    before = resident()
    for _ in range(300):
        gyroakf.simulate(20_000, n=1)
        gyroakf.allan(np.arange(20_000.0) % 7)
    assert resident() - before < 30e6


def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_import_brings_numpy_and_nothing_else_of_weight():
    code = (
        "import sys, numpy; before = set(sys.modules); import gyroakf; "
        "print(*(set(sys.modules) - before))"
    )
    new = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    assert {name.split(".")[0] for name in new} - set(sys.stdlib_module_names) == {"gyroakf"}
    assert len(new) < 60


def test_import_before_and_after_other_libraries():
    for code in ("import gyroakf, numpy.linalg", "import numpy.linalg, gyroakf"):
        code += (
            "; numpy.linalg.svd(numpy.eye(300)); print(gyroakf.allan(range(100)).deviation.size)"
        )
        assert (
            subprocess.run(
                [sys.executable, "-c", code], capture_output=True, text=True
            ).stdout.strip()
            == "6"
        )


series = arrays.arrays(np.float64, st.integers(60, 400), elements=st.floats(-1e6, 1e6, width=32))


def spread(x):
    return np.ptp(x) > 1e-3 * max(1, np.abs(x).max())


@relaxed
@given(
    x=series,
    factor=st.sampled_from([0.5, 2.0, 1024.0, -4.0]),
    shift=st.sampled_from([0.0, 64.0, -1e3]),
)
def test_scale_and_shift(x, factor, shift):
    if not spread(x):
        return
    one, other = gyroakf.allan(x), gyroakf.allan(x * factor + shift)
    assert np.allclose(
        other.deviation, abs(factor) * one.deviation, rtol=1e-6, atol=1e-9 * np.ptp(x) * abs(factor)
    )


@relaxed
@given(x=series)
def test_reversal(x):
    if not spread(x):
        return
    one, other = gyroakf.allan(x), gyroakf.allan(x[::-1])
    assert np.allclose(other.deviation, one.deviation, rtol=1e-6, atol=1e-9 * np.ptp(x))


@relaxed
@given(x=series, seed=st.integers(0, 1000))
def test_what_stands_at_a_gap_does_not_count(x, seed):
    gaps = np.random.default_rng(seed).random(x.size) < 0.1
    x[gaps] = np.nan
    for function in (gyroakf.adf, gyroakf.kpss, gyroakf.mark_outliers):
        try:
            one = function(x).to_dict()
        except gyroakf.GyroakfError as error:
            with pytest.raises(type(error)):
                function(-x)
            continue
        assert one == function(np.copysign(x, np.where(gaps, -1, x))).to_dict()


@relaxed
@given(
    data=arrays.arrays(
        st.one_of(arrays.scalar_dtypes(), arrays.complex_number_dtypes()),
        arrays.array_shapes(max_dims=3, max_side=80),
    )
)
def test_any_array(data):
    for function in FUNCTIONS:
        try:
            function(data)
        except REFUSED:
            pass


@relaxed
@given(saved=st.binary(max_size=2000), at=st.integers(0, 300), byte=st.integers(0, 255))
def test_damaged_states(saved, at, byte):
    good = bytearray(gyroakf.Filter([0.5, 0.1], 1, 1).__reduce__()[1][0])
    good[at % len(good)] = byte
    for state in (saved, bytes(good), bytes(good[:at])):
        try:
            gyroakf._filters._restore(state).step(1.0)
        except REFUSED:
            pass


def test_a_null_pointer_is_refused():
    with pytest.raises(gyroakf.InvalidArgumentError):
        gyroakf._library.call("filter_run", None, None, 1, None)
    assert gyroakf._library.LIBRARY.gyroakf_allan_size(ctypes.c_void_p()) == 0
