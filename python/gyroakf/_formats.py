# SPDX-License-Identifier: MIT
"""Recordings of other programs, read by the Python libraries of their fields, handed over as CSV.

Each reader returns columns by header: "time [s]", "gx [rad/s]", ... The library reads that text, so
that time stamps, gaps and units are treated as those of every file.
"""

from __future__ import annotations

import importlib
import io
import os
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, List, Optional

import numpy as np

from ._errors import GyroakfError, InvalidArgumentError, NotSupportedError, ParseError

Table = Dict[str, Any]
AXES = "xyz"
# Units of ROS (REP 103), of PX4's sensor topics and of ArduPilot's IMU message: SI
GYRO = [f"g{axis} [rad/s]" for axis in AXES]
ACCELEROMETER = [f"a{axis} [m/s^2]" for axis in AXES]


def library(name: str, extra: str) -> Any:
    """A module that is needed for a format."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise NotSupportedError(
            f'{name} is needed for this file: pip install "gyroakf[{extra}]"'
        ) from None


def choose(what: str, given: Optional[str], found: Iterable[str]) -> str:
    """The topic, message or variable of this name, or the only one."""
    names = sorted(set(found))
    if given in names:
        return str(given)
    if given is None and len(names) == 1:
        return names[0]
    raise InvalidArgumentError(f"`topic` must name a {what} of the file: {', '.join(names)}")


def ros(path: Path, topic: Optional[str], instance: int) -> Table:
    """ROS 1 and ROS 2 bags, MCAP: messages sensor_msgs/Imu, times of their headers."""
    reader = library("rosbags.highlevel", "ros").AnyReader
    stores = library("rosbags.typesys", "ros")
    folder = path.parent if path.suffix == ".db3" else path
    store = stores.get_typestore(stores.Stores.ROS2_HUMBLE)
    with reader([folder], default_typestore=store) as bag:
        imu = [c for c in bag.connections if c.msgtype == "sensor_msgs/msg/Imu"]
        name = choose("topic of sensor_msgs/Imu", topic, (c.topic for c in imu))
        stamps, rows = [], []
        for connection, _, raw in bag.messages([c for c in imu if c.topic == name]):
            message = bag.deserialize(raw, connection.msgtype)
            stamps.append((message.header.stamp.sec, message.header.stamp.nanosec))
            vectors = (message.angular_velocity, message.linear_acceleration)
            rows.append([getattr(vector, axis) for vector in vectors for axis in AXES])
    seconds, nanoseconds = np.array(stamps, np.int64).reshape(-1, 2).T
    time = (seconds - seconds[:1]) + nanoseconds * 1e-9
    return {"time [s]": time, **dict(zip(GYRO + ACCELEROMETER, np.array(rows).reshape(-1, 6).T))}


def ulog(path: Path, topic: Optional[str], instance: int) -> Table:
    """PX4: a topic of the log, sensor_gyro or sensor_combined without a choice."""
    log = library("pyulog", "ulog").ULog(os.fspath(path))
    found = {data.name: data for data in log.data_list if data.multi_id == instance}
    usual = [name for name in ("sensor_gyro", "sensor_combined") if name in found]
    data = found[choose("topic", topic or (usual[0] if usual else None), found)].data
    stamp = "timestamp_sample" if "timestamp_sample" in data else "timestamp"
    table = {"time [us]": data[stamp]}
    for i, axis in enumerate(AXES):
        for source, headers in (
            (axis, ACCELEROMETER if topic == "sensor_accel" else GYRO),
            (f"gyro_rad[{i}]", GYRO),
            (f"accelerometer_m_s2[{i}]", ACCELEROMETER),
        ):
            if source in data:
                table[headers[i]] = data[source]
    if "temperature" in data:
        table["temperature"] = data["temperature"]
    if len(table) == 1:
        table.update({key: data[key] for key in data if not key.startswith("timestamp")})
    return table


def dataflash(path: Path, topic: Optional[str], instance: int) -> Table:
    """ArduPilot: messages IMU, or those of another name, of one instance of the sensor."""
    log = library("pymavlink.DFReader", "dataflash").DFReader_binary(os.fspath(path))
    name = choose("message", topic or "IMU", log.name_to_id)
    messages: List[Any] = []
    while True:
        message = log.recv_match(type=name)
        if message is None:
            break
        if getattr(message, "I", instance) == instance:
            messages.append(message)
    headers = {"TimeUS": "time [us]", "T": "temperature"}
    headers.update({f"Gyr{axis.upper()}": GYRO[i] for i, axis in enumerate(AXES)})
    headers.update({f"Acc{axis.upper()}": ACCELEROMETER[i] for i, axis in enumerate(AXES)})
    fields = messages[0].get_fieldnames() if messages else []
    kept = [f for f in fields if f in headers or topic not in (None, "IMU")]
    return {headers.get(f, f): np.array([getattr(m, f) for m in messages]) for f in kept}


def matlab(path: Path, topic: Optional[str], instance: int) -> Table:
    """MATLAB: an array with a column for each channel, of all versions of MAT-files."""
    if path.read_bytes()[:10] == b"MATLAB 7.3":
        with library("h5py", "mat").File(path) as file:
            arrays = {name: file[name][()].T for name in file if hasattr(file[name], "dtype")}
    else:
        arrays = library("scipy.io", "mat").loadmat(path)
    usable = {k: v for k, v in arrays.items() if getattr(v, "dtype", np.dtype("O")).kind in "iuf"}
    array = usable[choose("variable", topic, usable)]
    if array.ndim != 2:
        raise InvalidArgumentError("the variable must have two dimensions")
    columns = array.T if array.shape[0] > 1 else array
    return {f"column{i + 1}": column for i, column in enumerate(columns)}


def parquet(path: Path, topic: Optional[str], instance: int) -> Table:
    """Apache Parquet: the columns with numbers; their names may hold units, as "gx [deg/s]"."""
    table = library("pyarrow.parquet", "parquet").read_table(path)
    columns = {name: table[name].to_pandas() for name in table.column_names}
    return {
        k: v.to_numpy(float, na_value=np.nan) for k, v in columns.items() if v.dtype.kind in "iuf"
    }


Reader = Callable[[Path, Optional[str], int], Table]
MAGIC: Dict[bytes, Reader] = {
    b"#ROSBAG V": ros,
    b"\x89MCAP0": ros,
    b"SQLite format 3": ros,
    b"ULog\x01\x12\x35": ulog,
    b"\xa3\x95\x80": dataflash,
    b"MATLAB ": matlab,
    b"PAR1": parquet,
}


def reader_of(path: Any) -> Optional[Reader]:
    """The reader of a file, or of the folder of a ROS 2 bag; None where the library reads it."""
    try:
        if os.path.isdir(path):
            return ros if os.path.exists(os.path.join(path, "metadata.yaml")) else None
        with open(path, "rb") as file:
            start = file.read(16)
    except (OSError, ValueError):
        return None
    return next((reader for magic, reader in MAGIC.items() if start.startswith(magic)), None)


def as_csv(path: Any, reader: Reader, topic: Optional[str] = None, instance: int = 0) -> bytes:
    """The recording as CSV with a header."""
    try:
        table = reader(Path(path), topic, instance)
    except GyroakfError:
        raise
    except Exception as error:  # the library of the format raises what it likes
        raise ParseError(f"{path}: {type(error).__name__}: {error}") from error
    if not table or not len(next(iter(table.values()))):
        raise InvalidArgumentError(f"{path} has no samples of this kind")
    text = io.StringIO()
    rows = np.column_stack([np.asarray(column, np.float64) for column in table.values()])
    np.savetxt(text, rows, "%.17g", ",", header=",".join(table), comments="")
    return text.getvalue().encode()
