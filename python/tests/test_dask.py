# SPDX-License-Identifier: MIT
"""Many recordings on a cluster of Dask: the table of one process."""

import numpy as np
import pytest

import gyroakf


def row(path):
    fit = gyroakf.noise_fit(gyroakf.allan(path))
    return fit.n.value, fit.b.upper_limit, fit.k.upper_limit


def test_two_workers(tmp_path):
    distributed = pytest.importorskip("distributed")
    files = [str(tmp_path / f"{seed}.npy") for seed in range(200)]
    for seed, path in enumerate(files):
        np.save(path, gyroakf.simulate(3000, n=0.01, seed=seed)["gx"])
    with distributed.LocalCluster(2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            table = client.gather(client.map(row, files))
            curve = client.submit(gyroakf.allan, files[0]).result()
    assert table == [row(path) for path in files]
    assert curve.to_dict() == gyroakf.allan(files[0]).to_dict()
    with pytest.raises(ValueError, match="another process"):
        gyroakf.noise_fit(curve)
