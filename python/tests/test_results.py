# SPDX-License-Identifier: MIT
"""Results against closed forms, against each other and against the program."""

import copy
import gc
import json
import pickle
import subprocess

import numpy as np
import pytest

import gyroakf
from gyroakf import _library


def test_every_function_of_the_header_has_its_types():
    header = (_library.FOLDER / "gyroakf.h").read_text()
    declared = header.count("\nGYROAKF_API ")
    typed = [
        name
        for name, f in vars(_library.LIBRARY).items()
        if name.startswith("gyroakf_") and f.argtypes is not None
    ]
    assert declared > 50
    assert len(typed) == declared
    assert gyroakf.__version__ == _library.LIBRARY.gyroakf_version_string().decode()


def test_structures_have_the_sizes_that_the_library_expects():
    for name, kind in _library.TYPES.items():
        if name.endswith("_options"):
            struct = _library.options(name[len("gyroakf_") :])
            assert struct.struct_size == _library.ctypes.sizeof(kind), name


def test_read_is_zero_copy_and_outlives_the_recording(example):
    values = gyroakf.read(example)["gx"]
    gc.collect()
    lines = [line for line in open(example) if not line.startswith("#")]
    assert values.tolist() == [float(line) for line in lines]
    with pytest.raises(ValueError):
        values[0] = 1


def test_read_options(tmp_path):
    path = tmp_path / "raw data ü.bin"
    np.arange(12, dtype=">i2").tofile(path)
    log = gyroakf.read(
        path, format="i16be", channels=3, rate=10, unit=["deg/s", "mg"], column=[1, 3], scale=0.5
    )
    assert log["column3"].tolist() == [1, 2.5, 4, 5.5]
    assert log.units == ("deg/s", "mg") and log.rate == 10 and log.rate_source == "option"
    with pytest.raises(KeyError):
        log["gz"]
    with pytest.raises(ValueError, match="column"):
        gyroakf.allan(log)
    text = tmp_path / "log.csv"
    text.write_text("gx\n1\nx\n3\n4\n")
    with pytest.raises(gyroakf.ParseError, match="log.csv:3:1"):
        gyroakf.read(text)
    log = gyroakf.read(text, bad_lines="missing")
    assert np.isnan(log["gx"][1]) and log.audit["bad_lines"] == 1


def test_allan_of_every_input_alike(log, tmp_path):
    x = log["gx"]
    np.save(tmp_path / "x.npy", x)
    expected = gyroakf.allan(log).deviation
    for data in (x, list(x), x.reshape(-1, 2).ravel(), tmp_path / "x.npy", str(tmp_path / "x.npy")):
        assert gyroakf.allan(data, 10).deviation.tolist() == expected.tolist()
    single = x.astype(np.float32)
    assert (
        gyroakf.allan(single).deviation.tolist()
        == gyroakf.allan(single.astype(float)).deviation.tolist()
    )
    assert gyroakf.allan(np.repeat(x, 2)[::2]).deviation.tolist() == expected.tolist()


def test_tables_and_text_are_alike(log):
    curve = gyroakf.allan(log, taus=[0.1, 0.2, 0.4])
    assert curve.to_dict()["tau"] == [0.1, 0.2, 0.4]
    for result in (
        curve,
        gyroakf.noise_fit(log),
        gyroakf.adf(log),
        gyroakf.kpss(log),
        gyroakf.ar(log),
        gyroakf.mark_outliers(log),
        gyroakf.identify_drift(log),
        gyroakf.Filter([0.5], 1, 1).state,
        gyroakf.identify_drift(log).smooth(log),
        log,
    ):
        json.dumps(result.to_dict())
        assert result._repr_html_().startswith("<table>")
        assert pickle.loads(pickle.dumps(result)).to_dict() == result.to_dict()


def test_frames(log):
    pandas = pytest.importorskip("pandas")
    curve = gyroakf.allan(log)
    assert list(curve.to_frame()) == ["tau", "deviation", "lower", "upper", "edf"]
    assert log.to_frame()["time_s"].iloc[-1] == pytest.approx(1999.9)
    assert gyroakf.noise_fit(log).to_frame().set_index("term").loc["N", "value"] == pytest.approx(
        0.005, rel=0.05
    )
    with_gap = pandas.Series([1, None] + [3, 1] * 40, dtype="Float64")
    assert gyroakf.allan(with_gap).deviation[0] > 0
    report = gyroakf.run(log).to_frame()
    assert set(report["term"]) == set("QNBKR")


def test_plots(log):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    assert gyroakf.allan(log).plot().get_xlabel() == "averaging time / s"
    log.plot()
    gyroakf.run(log).plot()
    gyroakf.identify_drift(log).smooth(log).plot()


def test_filter_steps_and_runs_alike(noise):
    options = dict(estimate_measurement_variance=1, forgetting=0.99)
    one = gyroakf.Filter([0.5, 0.2], 0.1, 1, **options)
    other = gyroakf.Filter([0.5, 0.2], 0.1, 1, **options)
    noise[10:20] = np.nan
    steps = [one.step(z) for z in noise]
    assert steps[:1000] == other.run(noise[:1000]).tolist()
    moved = pickle.loads(pickle.dumps(other))
    copied = copy.deepcopy(other)
    in_place = noise[1000:].copy()
    assert copied.run(in_place, out=in_place) is in_place
    assert (
        steps[1000:]
        == other.run(noise[1000:]).tolist()
        == moved.run(noise[1000:]).tolist()
        == in_place.tolist()
    )
    assert one.state == other.state and one.state.steps == 2000
    other.reset()
    other.freeze()
    assert other.run(noise)[:50].tolist() == steps[:50] or other.state.r == 1


def test_drift_of_a_known_random_walk(log):
    model = gyroakf.identify_drift(log)
    assert (
        model.phi == (1.0,)
        and model.q[0] == pytest.approx(5e-4**2 / 10, rel=0.5)
        and model.r == pytest.approx(0.005**2 * 10, rel=0.1)
    )
    smooth = model.smooth(log, estimate_measurement_variance=1)
    assert np.std(log["gx"] - smooth.drift) < np.std(log["gx"])
    forward = model.filter(huber=2.5).run(log["gx"])
    assert np.std(forward[5000:] - smooth.drift[5000:]) < 5 * np.sqrt(smooth.variance.max())


def test_run_is_the_program(example):
    report = gyroakf.run(example)
    program = [gyroakf.program(), "run", example]
    assert (
        str(report)
        == subprocess.run(program, capture_output=True, text=True, env={"LC_ALL": "C.UTF-8"}).stdout
    )
    said = subprocess.run([*program, "--json", "-"], capture_output=True, text=True).stdout
    assert {**report.to_dict(), "command_line": ""} == {**json.loads(said), "command_line": ""}
    assert "<pre>" in report._repr_html_()


def test_run_of_arrays_and_options(log, noise, tmp_path):
    report = gyroakf.run(
        np.stack([noise, noise[::-1]], 1), rate=100, unit="deg/s", max_order=5, ascii=True
    )
    assert [c["name"] for c in report.channels] == ["column1", "column2"]
    assert report.document["input"]["rate_hz"] == 100 and str(report).isascii()
    report = gyroakf.run(log)
    assert report.document["input"]["unit"] == "deg/s"
    assert [c["name"] for c in report.channels] == list(log.names)
    (tmp_path / "temp.csv").write_text("temp,gy\n" + "".join(f"{x},{-x}\n" for x in noise))
    both = gyroakf.read(tmp_path / "temp.csv", column=[1, 2], unit="deg/s", rate=100)
    assert [c["name"] for c in gyroakf.run(both).channels] == ["temp", "gy"]
    (tmp_path / "unknown.csv").write_text("gx\n" + "\n".join(map(str, noise)))
    unknown = gyroakf.run(gyroakf.read(tmp_path / "unknown.csv")).document["input"]
    assert unknown["rate_source"] == "none" and not unknown["unit"]
    long, told = np.tile(noise, 20), []
    gyroakf.run(long, progress=lambda *stage: told.append(stage))
    assert told and all(0 <= done <= total == 100 for _, done, total in told)
    with pytest.raises(ZeroDivisionError):
        gyroakf.run(long, progress=lambda *_: 1 / 0)
    with pytest.raises(gyroakf.UsageError, match="--no-such-option"):
        gyroakf.run(log, no_such_option=1)
    with pytest.raises(gyroakf.ParseError, match="does-not-exist"):
        gyroakf.run("does-not-exist.csv")


def test_statements_of_the_c_library_agree_with_the_program(example):
    document = gyroakf.run(example, outliers="none", detrend="none").channels[0]
    adf = document["tests"]["adf"]
    assert gyroakf.adf(example).statistic == pytest.approx(adf["statistic"], rel=1e-12)
    assert gyroakf.adf(example).critical == pytest.approx(adf["critical"], rel=1e-12)
    kpss = document["tests"]["kpss"]["statistic"]
    assert gyroakf.kpss(example).statistic == pytest.approx(kpss, rel=1e-12)
    assert gyroakf.ar(example, max_order=3).coefficients == pytest.approx(
        document["ar"]["coefficients"], rel=1e-12
    )
    assert gyroakf.allan(example).deviation == pytest.approx(
        document["allan"]["input"]["deviation"], rel=1e-12
    )


def test_limits_and_filters_are_those_of_the_program(example, tmp_path):
    out = tmp_path / "results.json"
    subprocess.run([gyroakf.program(), "run", example, "--json", out, "--quiet"], check=True)
    channel = json.loads(out.read_text())["channels"][0]
    log = gyroakf.read(example)
    curve = gyroakf.allan(log, fit=True)
    for name in ("deviation", "lower", "upper", "edf"):
        assert getattr(curve, name).tolist() == channel["allan"]["input"][name]
    cleaned = gyroakf.clean(log)
    for kind in ("kf", "akf"):
        kalman, mean = gyroakf.identify_filter(log, kind)
        kalman.run(cleaned - mean)
        assert kalman.state.q == channel["filters"][kind]["q"]
        assert kalman.state.r == channel["filters"][kind]["r"]
    with pytest.raises(gyroakf.InvalidArgumentError):
        gyroakf.identify_filter(log, "kalman")


def test_a_unit_names_that_of_an_array_and_converts_nothing():
    log = gyroakf.simulate(1000, n=0.005)
    assert gyroakf.allan(log["gx"], rate=log.rate, unit="rad/s").unit == "rad/s"
    assert gyroakf.allan(log, unit="deg/s").unit == "deg/s"
    with pytest.raises(gyroakf.InvalidArgumentError, match="rad/s"):
        gyroakf.allan(log, unit="rad/s")
