# SPDX-License-Identifier: MIT
"""Files of other programs against the CSV of the same numbers."""

import json
import struct
import subprocess
import sys

import numpy as np
import pytest

import gyroakf

N = 400
TIME = np.delete(np.arange(N + 3), [100, 101, 250]) * 0.01  # two gaps
VALUES = np.random.default_rng(5).standard_normal((N, 6)).astype(np.float32).astype(float)
NAMES = ["gx", "gy", "gz", "ax", "ay", "az"]


@pytest.fixture
def expected(tmp_path):
    path = tmp_path / "expected.csv"
    header = "time [s]," + ",".join(f"{n} [{'rad/s' if n[0] == 'g' else 'm/s^2'}]" for n in NAMES)
    np.savetxt(path, np.column_stack([TIME, VALUES]), "%.17g", ",", header=header, comments="")
    return gyroakf.read(path)


def same(found, expected, columns=6):
    assert found.names == expected.names[:columns]
    assert found.units == expected.units[:columns]
    assert found.dt == pytest.approx(expected.dt, rel=1e-12)
    assert found.audit["gaps"] == 2 and found.audit["missing"] == 3 * columns
    for one, other in zip(found.values, expected.values):
        assert np.array_equal(one, other, equal_nan=True)


def write_bag(path, kind):
    rosbags = pytest.importorskip("rosbags.typesys")
    from rosbags import rosbag1, rosbag2

    old = kind == "bag"
    store = rosbags.get_typestore(rosbags.Stores.ROS1_NOETIC if old else rosbags.Stores.ROS2_HUMBLE)
    types = store.types
    imu, header = types["sensor_msgs/msg/Imu"], types["std_msgs/msg/Header"]
    stamp, vector = types["builtin_interfaces/msg/Time"], types["geometry_msgs/msg/Vector3"]
    still = types["geometry_msgs/msg/Quaternion"](0, 0, 0, 1)
    nine = np.zeros(9)
    if old:
        writer, serialize = rosbag1.Writer(path), store.serialize_ros1
    else:
        plugin = rosbag2.StoragePlugin.MCAP if kind == "mcap" else rosbag2.StoragePlugin.SQLITE3
        writer, serialize = (
            rosbag2.Writer(path, version=9, storage_plugin=plugin),
            store.serialize_cdr,
        )
    with writer:
        connections = [
            writer.add_connection(topic, "sensor_msgs/msg/Imu", typestore=store)
            for topic in ("/imu", "/other")
        ]
        for t, row in zip(TIME, VALUES):
            ns = 1_700_000_000_000_000_000 + round(t * 1e9)
            at = stamp(ns // 10**9, ns % 10**9)
            head = header(0, at, "") if old else header(at, "")
            for connection, sign in zip(connections, (1, -1)):
                row = sign * row
                message = imu(head, still, nine, vector(*row[:3]), nine, vector(*row[3:]), nine)
                writer.write(connection, ns, serialize(message, "sensor_msgs/msg/Imu"))


@pytest.mark.parametrize("kind", ["bag", "mcap", "db3"])
def test_ros(tmp_path, expected, kind):
    path = tmp_path / ("log.bag" if kind == "bag" else "log")
    write_bag(path, kind)
    same(gyroakf.read(path, topic="/imu"), expected)
    if kind != "bag":
        same(gyroakf.read(next(path.glob(f"*.{kind}")), topic="/imu"), expected)
    with pytest.raises(ValueError, match="/imu, /other"):
        gyroakf.read(path)
    report = gyroakf.run(path, topic="/imu")
    assert [c["name"] for c in report.channels] == NAMES
    command = [sys.executable, "-m", "gyroakf", "allan", str(path), "--topic", "/imu"]
    said = subprocess.run([*command, "--json", "-"], capture_output=True, text=True)
    assert [c["name"] for c in json.loads(said.stdout)["channels"]] == NAMES


def ulog_message(kind, content):
    return struct.pack("<HB", len(content), ord(kind)) + content


def test_ulog(tmp_path, expected):
    pytest.importorskip("pyulog")
    fields = b"uint64_t timestamp;float[3] gyro_rad;float[3] accelerometer_m_s2;"
    log = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)
    log += ulog_message("B", bytes(40)) + ulog_message("F", b"sensor_combined:" + fields)
    log += ulog_message("A", struct.pack("<BH", 0, 1) + b"sensor_combined")
    for t, row in zip(TIME, VALUES):
        log += ulog_message("D", struct.pack("<HQ6f", 1, round(t * 1e6) + 5_000_000, *row))
    (tmp_path / "log.ulg").write_bytes(log)
    same(gyroakf.read(tmp_path / "log.ulg"), expected)
    assert gyroakf.read(tmp_path / "log.ulg", column="gz").names == ("gz",)
    with pytest.raises(ValueError, match="sensor_combined"):
        gyroakf.read(tmp_path / "log.ulg", topic="sensor_gyro")


def test_dataflash(tmp_path, expected):
    pytest.importorskip("pymavlink")

    def fmt(number, length, name, kinds, labels):
        return struct.pack("<3B2B4s16s64s", 0xA3, 0x95, 128, number, length, name, kinds, labels)

    log = fmt(128, 89, b"FMT", b"BBnNZ", b"Type,Length,Name,Format,Columns")
    log += fmt(129, 36, b"IMU", b"QBffffff", b"TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ")
    for t, row in zip(TIME, VALUES):
        for instance in (0, 1):
            content = struct.pack(
                "<QB6f", round(t * 1e6) + 9_000_000, instance, *(row * (1 - 2 * instance))
            )
            log += b"\xa3\x95" + bytes([129]) + content
    (tmp_path / "log.bin").write_bytes(log)
    same(gyroakf.read(tmp_path / "log.bin"), expected)
    other = gyroakf.read(tmp_path / "log.bin", instance=1)
    assert np.array_equal(other["gx"], -expected["gx"], equal_nan=True)


@pytest.mark.parametrize("version", [5, 7])
def test_matlab(tmp_path, version):
    path = tmp_path / "log.mat"
    if version == 5:
        pytest.importorskip("scipy.io").savemat(path, {"gyro": VALUES, "note": "x"})
    else:
        h5py = pytest.importorskip("h5py")
        with h5py.File(path, "w", userblock_size=512) as file:
            file["gyro"] = VALUES.T
        with open(path, "r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file".ljust(128))
    log = gyroakf.read(path, topic="gyro", rate=100, unit="deg/s")
    assert log.rate == 100 and len(log.names) == 6
    assert all(np.array_equal(log.values[i], VALUES[:, i]) for i in range(6))
    with pytest.raises(ValueError, match="gyro"):
        gyroakf.read(path, topic="x")


def test_parquet(tmp_path, expected):
    arrow = pytest.importorskip("pyarrow")
    pytest.importorskip("pandas")
    parquet = pytest.importorskip("pyarrow.parquet")
    names = [f"{n} [{unit}]" for n, unit in zip(NAMES, expected.units)]
    columns = {"time [s]": TIME, **dict(zip(names, VALUES.T)), "mode": ["a"] * N}
    parquet.write_table(arrow.table(columns), tmp_path / "log.parquet")
    same(gyroakf.read(tmp_path / "log.parquet"), expected)


@pytest.mark.parametrize("start", gyroakf._formats.MAGIC)
def test_damaged_files(tmp_path, start):
    path = tmp_path / "damaged"
    path.write_bytes(start + bytes(range(256)))
    with pytest.raises(
        (gyroakf.ParseError, gyroakf.NotSupportedError, gyroakf.InvalidArgumentError)
    ):
        gyroakf.read(path)
    said = subprocess.run(
        [sys.executable, "-m", "gyroakf", str(path)], capture_output=True, text=True
    )
    assert said.returncode == 1 and said.stderr.splitlines()[-1].startswith("gyroakf: error: ")
