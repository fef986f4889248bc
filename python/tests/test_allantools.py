# SPDX-License-Identifier: MIT
"""gyroakf.allantools against the package of that name."""

import numpy as np
import pytest

import gyroakf.allantools as ours

theirs = pytest.importorskip("allantools")
TAUS = [None, "octave", "decade", "log10", "all", [1, 2.2, 7.7, 100, 1e9], np.array([0.1, 0.3])]


@pytest.mark.parametrize("kind", ours.__all__)
@pytest.mark.parametrize("data_type", ["phase", "freq"])
@pytest.mark.parametrize("taus", TAUS, ids=str)
def test_same_values(kind, data_type, taus, noise):
    data = noise + 3 if data_type == "freq" else np.cumsum(noise)
    found = getattr(ours, kind)(data, 10.0, data_type, taus)
    expected = getattr(theirs, kind)(data, 10.0, data_type, taus)
    # allantools goes on with the total deviation beyond half of the record
    half = expected[0] <= found[0][-1] if kind == "totdev" else np.full(len(expected[0]), True)
    for one, other in zip(found, expected):
        assert np.allclose(one, other[half], rtol=1e-9, atol=0)


def test_refused():
    for given in (dict(data_type="x"), dict(taus="x"), dict(taus=[1e9]), dict(rate=0)):
        with pytest.raises((ValueError, UserWarning, ZeroDivisionError)):
            ours.oadev(np.arange(100.0), **given)
