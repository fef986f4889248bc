# SPDX-License-Identifier: MIT
"""Runs `gyroakf allan` on the recordings of a table and prints coefficients beside expected figures.

compare.py TABLE DIR CONVERTED PROGRAM      CONVERTED: folder with the output of convert.py

An asterisk marks a deviation above the tolerance, or a coefficient whose state (value, limit, withheld) is not the expected one.
"""
import csv
import json
import math
import os
import shlex
import subprocess
import sys

N_TOLERANCE, B_TOLERANCE = 3, 15  # percent
WIDTHS = (7, 14, 10, 10, 7, 6, 11, 5, 6, 5, 8, 7, 4, 7)
HEAD = ("channel", "N", "B", "K", "N read", "min.", "tau, s", "floor", "chi2", "with-", "N", "off %", "B", "off %")
SECOND = ("", "", "", "", "off", "", "of the fit", "%", "/dof", "held", "exp.", "", "exp.", "")


def recordings(table):
    """Rows of the table, grouped by (repository, path, conversion, options)."""
    groups = {}
    with open(table, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            groups.setdefault(tuple(row[k] for k in ("repository", "path", "conversion", "options")), []).append(row)
    return groups


def find(folder, path):
    """The file with the base name of path below folder, preferably at the path itself; None where there is none."""
    name = os.path.basename(path)
    found = sorted(os.path.join(root, name) for root, _, files in os.walk(folder) if name in files)
    return next((file for file in found if file.endswith(os.sep + path)), found[0] if found else None)


def converted_path(folder, path):
    return os.path.join(folder, os.path.splitext(os.path.basename(path))[0] + ".csv")


def state(coefficient):
    """value, limit, withheld, or none (term not fitted); derived from `detected` where the document has no state."""
    if coefficient.get("state"):
        return coefficient["state"]
    if coefficient["value"] is None:
        return "none"
    return "value" if coefficient["detected"] else "limit"


def short(number, digits=3):
    """Significant digits without an exponent where that is legible."""
    if number is None:
        return "-"
    if number == 0 or 1e-3 <= abs(number) < 1e5:
        return f"{number:.{max(0, digits - 1 - math.floor(math.log10(abs(number)))) if number else 0}f}"
    return f"{number:.1e}".replace("e+0", "e").replace("e-0", "e-")


def stated(coefficient):
    """Value with two digits of its standard error, upper limit, or state."""
    what = state(coefficient)
    if what == "value":
        value, error = coefficient["value"], coefficient["std_error"]
        if not error:
            return short(value)
        decimals = max(0, 1 - math.floor(math.log10(error)))
        return f"{value:.{decimals}f}+-{error:.{decimals}f}"
    if what == "limit":
        return "< " + short(coefficient["upper_limit"])
    return "-" if what == "none" else what


def judge(counts, what, coefficient, expected, tolerance):
    """Cell with the deviation in percent; counts[what] = [within, judged, within but standard error above the tolerance]."""
    deviation, good, wide = None, state(coefficient) == expected, False
    if tolerance and state(coefficient) == "value":
        deviation = 100 * (coefficient["value"] / float(expected) - 1)
        good = abs(deviation) <= tolerance
        wide = good and 100 * (coefficient["std_error"] or 0) > tolerance * abs(coefficient["value"])
    counts[what] = [old + new for old, new in zip(counts.get(what, (0, 0, 0)), (good, 1, wide))]
    return ("-" if deviation is None else f"{deviation:+.1f}") + (" " if good else "*")


def cells(row, channel, counts):
    """Cells of a channel; adds its judgment to counts."""
    fitted = channel["coefficients"]["input"]
    what, b_off = row["expectation"], ""
    if fitted is None:
        return [row["channel"], "no fit", judge(counts, "channels without a fit", {"state": "none"}, "value", None)]
    fit = fitted["fit"]
    tau = fit.get("tau_s") or channel["allan"]["input"]["tau_s"]
    if what == "value":
        n_off = judge(counts, f"N within {N_TOLERANCE} %", fitted["N"], row["N_deg_per_sqrt_h"], N_TOLERANCE)
    else:
        n_off = judge(counts, f"N {what} as expected", fitted["N"], what, None)
    if row["B_deg_per_h"]:
        b_off = judge(counts, f"B within {B_TOLERANCE} %", fitted["B"], row["B_deg_per_h"], B_TOLERANCE)
    return [row["channel"], stated(fitted["N"]), stated(fitted["B"]), stated(fitted["K"]), short(fitted["read_off"]["N"], 4),
            short(fitted["read_off"]["minimum"]), f"{short(fit['tau_first_s'], 2)}..{short(fit.get('tau_last_s') or tau[-1], 2)}",
            short(fit.get("floor_percent"), 2), short(fitted["chi2_reduced"]),
            "".join(term for term in "QNBKR" if state(fitted[term]) == "withheld") or "-",
            row["N_deg_per_sqrt_h"] or what, n_off, row["B_deg_per_h"] or "-", b_off]


def line(values):
    return " ".join(f"{v:>{w}}" if i else f"{v:<{w}}" for i, (v, w) in enumerate(zip(values, WIDTHS))).rstrip()


def main():
    table, folder, converted, program = sys.argv[1:]
    counts, missing, failed = {}, [], 0
    print(line(HEAD), line(SECOND), sep="\n")
    for (repository, path, conversion, options), rows in recordings(table).items():
        file = find(folder, path) if conversion == "none" else converted_path(converted, path)
        if file is None or not os.path.exists(file):
            missing.append(os.path.basename(path))
            continue
        run = subprocess.run([program, "allan", file, *shlex.split(options), "--quiet", "--json", "-"],
                             capture_output=True, text=True, check=False)
        print(f"\n{repository}{': ' if repository else ''}{path} {options}")
        if run.returncode != 0 or not run.stdout:
            print(f"  failed ({run.returncode}): {run.stderr.strip()}")
            failed += len(rows)
            continue
        channels, units = {c["name"]: c for c in json.loads(run.stdout)["channels"]}, None
        for row in rows:
            channel = channels[row["channel"]]
            fitted = channel["coefficients"]["input"] or {}
            if fitted and units != (units := [fitted[term]["unit"] for term in "NBK"]):
                print("  N, B, K in", ", ".join(units))
            print(line(cells(row, channel, counts)))
    print()
    for what, (within, judged, wide) in counts.items():
        print(f"{what}: {within} of {judged} channels" + (f", {wide} of them with a larger standard error" if wide else ""))
    if failed:
        print(f"failed: {failed} channels")
    if missing:
        print("not found:", ", ".join(dict.fromkeys(missing)))


if __name__ == "__main__":
    main()
