# SPDX-License-Identifier: MIT
"""Allan statistics beside allantools: deviations, number of terms, degrees of freedom, limits: allan.py PROGRAM FOLDER."""
import warnings

import allantools
import numpy
from allantools import ci as limits
from scipy.stats import chi2
from table import Gyroakf, Table, relative

warnings.simplefilter("ignore")
RATE, PROBABILITY = 10.0, 0.683
KINDS = ["adev", "oadev", "mdev", "tdev", "hdev", "ohdev", "totdev"]
# kind: order of the difference, overlapping, modified: as Greenhall and Riley name them
SHAPE = {"adev": (2, False, False), "oadev": (2, True, False), "mdev": (2, True, True), "tdev": (2, True, True),
         "hdev": (3, False, False), "ohdev": (3, True, False)}
# term: exponent of the fractional frequency, generalised covariance of the phase at the lag t in samples
NOISE = {"Q": (2, lambda t: (t == 0).astype(float)), "N": (0, lambda t: -abs(t) / 2),
         "B": (-1, lambda t: t**2 * numpy.log(numpy.maximum(abs(t), 1)) / (2 * numpy.pi)), "K": (-2, lambda t: abs(t)**3 / 12)}


def curves(found):
    """Kind: its curve."""
    return {"oadev": found["allan"]["input"], **found["allan"]["input"]["other_kinds"]}


def differences(kind, m, phases):
    """The differences of the phase that a kind squares, as a matrix."""
    x = numpy.eye(phases)
    if kind == "totdev":
        front, back = 2 * x[0] - x[1:-1][::-1], 2 * x[-1] - x[1:-1][::-1]
        wide, first = numpy.concatenate([front, x, back]), phases - 2
        i = numpy.arange(first + 1, first + phases - 1)
        return wide[i - m] - 2 * wide[i] + wide[i + m]
    if kind in ("hdev", "ohdev"):
        z = x[3 * m:] - 3 * x[2 * m:-m] + 3 * x[m:-2 * m] - x[:-3 * m]
    else:
        z = x[2 * m:] - 2 * x[m:-m] + x[:-2 * m]
    if kind in ("mdev", "tdev"):
        sums = numpy.concatenate([numpy.zeros((1, phases)), numpy.cumsum(z, axis=0)])
        return (sums[m:] - sums[:-m]) / m
    return z[::m] if kind in ("adev", "hdev") else z


def exact_freedom(kind, m, phases, covariance):
    """2 E(V)^2/Var(V) of the mean square V of normal differences z: (tr R)^2/tr R^2, R their covariance; no approximation."""
    t = numpy.subtract.outer(numpy.arange(phases), numpy.arange(phases)).astype(float)
    d = differences(kind, m, phases)
    r = d @ covariance(t) @ d.T
    return numpy.trace(r)**2 / numpy.sum(r * r)


def deviations(gyroakf):
    """All kinds on a record of several noises."""
    path, rate = gyroakf.record("mix", "--samples", "20000", "--rate", str(RATE), "--seed", "11", "--offset", "0.02",
                                "--coefficients", "Q=2e-5,N=0.005,B=0.001,K=5e-5,R=1e-8")
    found = curves(gyroakf.results("allan", path, "--rate", str(RATE), "--kinds", ",".join(KINDS)))
    table = Table("Deviations, octave averaging times, 20,000 samples of Q, N, B, K, R (seed 11)", "allantools 2024.6")
    for kind in KINDS:
        curve = found[kind]
        tau, theirs, _, terms = getattr(allantools, kind)(rate, rate=RATE, data_type="freq", taus=curve["tau_s"])
        table.row(f"{kind}, averaging times", len(curve["tau_s"]), len(tau),
                  "allantools leaves out a time of a single term", len(tau) + numpy.sum(numpy.array(curve["terms"]) == 1))
        assert relative(curve["tau_s"][:len(tau)], tau) < 1e-12, "averaging times"
        table.row(f"{kind}, the deviation that differs most", curve["deviation"][:len(tau)], theirs)
        table.row(f"{kind}, number of terms", curve["terms"][:len(tau)], terms)
    for kind in KINDS:
        curve = found[kind]
        theirs = numpy.transpose([limits.confidence_interval(dev, edf, ci=PROBABILITY)
                                  for dev, edf in zip(curve["deviation"], curve["edf"])])
        table.row(f"{kind}, lower limit, the same degrees of freedom", curve["lower"], theirs[0])
        table.row(f"{kind}, upper limit, the same degrees of freedom", curve["upper"], theirs[1])


def small_probability(gyroakf):
    """Limits of 95 %, and of 30 %, where allantools takes the other tail."""
    path, rate = gyroakf.record("white", "--samples", "2000", "--rate", str(RATE), "--seed", "12", "--coefficients", "N=0.005")
    table = Table("Limits of other probabilities, 2,000 samples of N (seed 12)", "allantools 2024.6")
    for probability in (0.95, 0.3):
        found = gyroakf.results("allan", path, "--rate", str(RATE), "--kinds", "adev", "--confidence", str(probability))
        curve = curves(found)["oadev"]
        dev, edf = numpy.array(curve["deviation"]), numpy.array(curve["edf"])
        theirs = [limits.confidence_interval(d, e, ci=probability)[0] for d, e in zip(dev, edf)]
        table.row(f"oadev, lower limit, {100 * probability:.0f} %", curve["lower"], theirs,
                  "allantools leaves min(P, 1 - P)/2 in each tail: below 50 % these are the limits of 1 - P",
                  dev * numpy.sqrt(edf / chi2.ppf((1 + probability) / 2, edf)))


# What makes either side differ from the exact sum
NOTES = """Why ours differ: those of oadev are of the fitted noise, a sum over lags by quadrature, beyond 32 averaging times left out; those of
the other kinds are Greenhall and Riley's, and NIST SP 1065's of totdev, for the noise type identified at each averaging time.

Why allantools' differ: (a) Greenhall and Riley let every phase be a mean over a sample interval (filter factor F = m) of noise
without end of its band; the phase of rates is their running sum, which is F without end: "their sum, F = inf" is that, by
allantools' own functions, over lags up to d + 1 averaging times, which is all of them but for flicker noise; (b) the modified
kinds: means of m phases as an integral; (c) beyond 100 lags their table takes the place of their sum; (d) SP1065's Table 7,
which at m = 1 gives more degrees of freedom than there are terms; (e) no formula for this noise; (f) NotImplementedError where
the terms span no more than d averaging times."""
LARGEST = 0.02  # relative error of ours that the notes explain


def freedom(gyroakf):
    """Degrees of freedom of pure noises, against allantools' approximations and the exact trace."""
    samples = 1000
    phases = samples + 1
    print("\n### Degrees of freedom of pure noises, 1,000 samples\n")
    print("Exact: (tr R)^2/tr R^2 of the covariance R of the differences, written out as matrices. The largest relative "
          "distance from it over the averaging times:\n")
    print("| noise | kind | gyroakf | allantools 2024.6 | worst at | gyroakf | allantools | exact | their sum, F = inf | reason |")
    print("|---|---|--:|--:|--:|--:|--:|--:|--:|---|")
    for number, (letter, (alpha, covariance)) in enumerate(NOISE.items()):
        path, _ = gyroakf.record("pure_" + letter, "--samples", str(samples), "--rate", "1", "--seed", str(20 + number),
                                 "--coefficients", letter + "=1")
        found = curves(gyroakf.results("allan", path, "--rate", "1", "--terms", letter, "--kinds", ",".join(KINDS)))
        for kind in KINDS:
            factors = [round(tau) for tau in found[kind]["tau_s"]]
            ours = numpy.array(found[kind]["edf"])
            exact = numpy.array([exact_freedom(kind, m, phases, covariance) for m in factors])
            theirs = numpy.array([their_freedom(kind, alpha, m, phases) for m in factors])
            off = abs(theirs / exact - 1)
            worst = int(numpy.nanargmax(off)) if not numpy.all(numpy.isnan(off)) else 0
            m = factors[worst]
            cells = [letter, kind, f"{relative(ours, exact):.1e}", shown(off[worst], ".1e"), m, shown(ours[worst]),
                     shown(theirs[worst]), shown(exact[worst]), shown(sampled_sum(kind, alpha, m, phases)),
                     why(kind, letter, off[worst], theirs)]
            print("|", " | ".join(map(str, cells)), "|")
            if kind == "oadev" and relative(ours, exact) > LARGEST:
                Table.failed.append(f"degrees of freedom, {letter}, {kind}")
    print("\n" + NOTES)


def shown(value, form=".6g"):
    """A number, - where there is none."""
    return "-" if numpy.isnan(value) else format(value, form)


def why(kind, letter, off, theirs):
    """The letters of the notes."""
    if kind == "totdev":
        return "(e)" if letter == "Q" else "(d)"
    reasons = ["(f)"] if numpy.any(numpy.isnan(theirs)) else []
    if off > 1e-9:
        reasons.append("(c)" if letter == "Q" else "(b)" if SHAPE[kind][2] else "(a)")
    return " ".join(reasons)


def sampled_sum(kind, alpha, m, phases):
    """Greenhall and Riley's sum for a phase that is sampled, not averaged: by allantools' functions."""
    if kind == "totdev" or SHAPE[kind][2]:
        return numpy.nan
    d, overlapping, _ = SHAPE[kind]
    f, s = m if alpha > 0 else float("inf"), m if overlapping else 1
    terms = 1 + (s * (phases - 1 - m * d)) // m
    lags = min(terms, (d + 1) * s)
    return limits.greenhall_sz(0, f, alpha, d)**2 * terms / limits.greenhall_BasicSum(lags, terms, s, f, alpha, d)


def their_freedom(kind, alpha, m, phases):
    """What allantools has; NaN where it raises."""
    try:
        if kind == "totdev":
            return limits.edf_totdev(phases, m, alpha) if alpha <= 0 else numpy.nan
        d, overlapping, modified = SHAPE[kind]
        return limits.edf_greenhall(alpha, d, m, phases, overlapping=overlapping, modified=modified)
    except NotImplementedError:
        return numpy.nan


program = Gyroakf()
print("\n## Allan statistics")
deviations(program)
small_probability(program)
freedom(program)
Table.finish()
