# SPDX-License-Identifier: MIT
"""What the comparisons share: records of the program under test, its results, and tables of differences with their reasons."""
import json
import os
import subprocess
import sys

import numpy

ROUNDING = 1e-9  # a relative difference up to here is rounding
EXPLAINED = 1e-9  # and so is what remains when a named difference is applied to the peer's number


class Gyroakf:
    """The program: makes records, gives the results of a command."""

    def __init__(self):
        self.program, self.folder = sys.argv[1], sys.argv[2]

    def record(self, name, *options):
        """The path of a simulated record, and its numbers."""
        path = os.path.join(self.folder, name + ".npy")
        self.run("simulate", *options, "--output", path, "--force")
        return path, numpy.load(path).reshape(-1).astype(float)

    def keep(self, name, values):
        """The path of a record of these numbers."""
        path = os.path.join(self.folder, name + ".npy")
        numpy.save(path, numpy.asarray(values, dtype=float))
        return path

    def run(self, *arguments):
        done = subprocess.run([self.program, *arguments], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"gyroakf {' '.join(arguments)}: {done.stderr}")
        return done.stdout

    def results(self, command, path, *options):
        """The first channel of the JSON document."""
        return json.loads(self.run(command, path, "--quiet", "--json", "-", *options))["channels"][0]


def relative(a, b):
    """The largest distance of two arrays over the size of the second."""
    a, b = numpy.asarray(a, float), numpy.asarray(b, float)
    return float(numpy.max(numpy.abs(a - b) / numpy.where(b == 0, 1, numpy.abs(b)), initial=0))


class Table:
    """A row per quantity: ours, the peer's, relative difference, the reason, and what remains when the reason is applied."""

    failed = []

    def __init__(self, title, peer):
        self.title = title
        print(f"\n### {title}\n")
        print(f"| quantity | gyroakf | {peer} | relative difference | reason | remains |")
        print("|---|--:|--:|--:|---|--:|")

    def row(self, quantity, ours, theirs, reason="", explained=None, tolerance=ROUNDING, show=None, scale=None):
        """Of arrays the elements that differ most are shown, or those of the index `show`; differences are relative to the peer's
        number, or to `scale`. `explained`: theirs, with the reason applied. NaN: the peer refuses."""
        ours, theirs = numpy.atleast_1d(ours).astype(float), numpy.atleast_1d(theirs).astype(float)
        size = numpy.where(theirs == 0, 1, numpy.abs(theirs)) if scale is None else scale
        off = numpy.abs(ours - theirs) / size
        worst = int(numpy.argmax(off))
        shown = worst if show is None else show
        differs = not off[worst] <= tolerance
        remains = None if explained is None else relative(ours, numpy.atleast_1d(explained))
        print(f"| {quantity} | {ours[shown]:.12g} | {theirs[shown]:.12g} | {off[worst]:.1e} | {reason if differs else ''} | "
              f"{f'{remains:.1e}' if differs and remains is not None else ''} |")
        if differs and (not reason or not (remains is None or remains <= EXPLAINED)):
            self.failed.append(f"{self.title}: {quantity}")

    @classmethod
    def finish(cls):
        """Ends the program with 1 where a difference has no reason."""
        for line in cls.failed:
            print(f"unexplained: {line}", file=sys.stderr)
        sys.exit(1 if cls.failed else 0)
