# SPDX-License-Identifier: MIT
import pathlib

import numpy as np
import pytest

import gyroakf

EXAMPLE = pathlib.Path(__file__).parents[2] / "example/data/mems_gyro_x.txt"


@pytest.fixture(scope="session")
def example():
    return str(EXAMPLE)


@pytest.fixture(scope="session")
def log():
    return gyroakf.simulate(20000, rate=10, n=0.005, k=5e-4, seed=3)


@pytest.fixture
def noise():
    return np.random.default_rng(1).standard_normal(2000)
