# SPDX-License-Identifier: MIT
"""Simulates records of known truth, analyzes them by `gyroakf run` and prints what is wrong.

zoo.py TABLE PROGRAM RECORDS

TABLE: name; options of simulate; the terms of the truth; N, B, K in the units of the report; the right verdicts, separated by |.
"""
import csv
import json
import math
import os
import re
import shlex
import subprocess
import sys
import tempfile

WIDTHS = (13, 7, 10, 10, 7, 9, 8, 9, 8, 6)
HEAD = ("row", "records", "false", "missed", "wrong", "N: RMSE", "within", "B: RMSE", "within", "contra-")
SECOND = ("", "", "terms", "terms", "verdict", "%", "1 SE", "%", "1 SE", "dict.")
CELLS = {"value": "value", "limit": "<", "withheld": "withheld", "": "-"}


def is_stated(coefficient):
    return coefficient["state"] == "value"


def stated(coefficient):
    """A coefficient in words."""
    if is_stated(coefficient):
        return f"{coefficient['value']:.4g} +- {coefficient['std_error']:.2g}"
    return f"< {coefficient['upper_limit']:.4g}" if coefficient["state"] == "limit" else coefficient["state"] or "not fitted"


def best(channel):
    """Coefficients of the record without its outliers, where there were any; {} where nothing was fitted."""
    return channel["coefficients"].get("outliers_removed") or channel["coefficients"]["input"] or {}


def table_row(text):
    """The cells of the row "raw" of the table of coefficients, as in CELLS."""
    found = re.search(r"^Table III\.[^\n]*\n(?:[^\n]*\n){1,4}?  raw +([^\n]*)", text, re.MULTILINE)
    if not found:
        return ["no row"] * 5
    return [cell if cell in ("-", "withheld") else "<" if cell[0] == "<" else "value"
            for cell in re.sub(r"< +", "<", found.group(1)).split()]


def drift_contradictions(channel, text):
    """The verdict against the drift model, the coefficients and the first line of the report."""
    verdict, drift, fitted = channel["verdict"], channel["drift"], channel["coefficients"]["input"] or {}
    walks = [p for p in (drift or {}).get("processes", []) if p["kind"] == "walk" and p["drift"]]
    noise = re.search(r"^Verdict\n +(.*)$", text, re.MULTILINE)
    word = {True: "stationary", False: "drifts", None: "not described"}[verdict["stationary"]]
    if not noise or not noise.group(1).startswith(word):
        yield f"text: \"{noise and noise.group(1)}\"; JSON: {word}"
    if verdict["stationary"]:
        if any(walk["k"] is not None for walk in walks):
            yield f"verdict {verdict['drift']}; the drift model has a random walk with a K"
        if walks and not re.search(r"no model describes|approximation of the slow part", re.sub(r"\s+", " ", text)):
            yield f"verdict {verdict['drift']}; the text has a random walk as drift"
        if verdict["trend"]:
            yield "verdict stationary; a trend is stated"
    if verdict["stationary"] is False and drift and not drift["found"]:
        yield f"verdict {verdict['drift']}; \"there is no drift\""
    if not fitted:
        return
    k = fitted["K"]
    if is_stated(k) and "random_walk" not in verdict["drift"]:
        yield f"verdict {verdict['drift']}; K = {stated(k)}"
    if verdict["drift"] in ("random_walk", "trend_and_random_walk") and not is_stated(k):
        yield f"verdict {verdict['drift']}; K {stated(k)}"
    if is_stated(fitted["R"]) and verdict["drift"] != "random_walk_or_trend":
        yield f"verdict {verdict['drift']}; R = {stated(fitted['R'])}"
    if verdict["drift"] == "flicker" and not is_stated(fitted["B"]):
        yield f"verdict flicker; B {stated(fitted['B'])}"
    for walk in walks:
        if walk["k"] is None or walk["k_unit"] != k["unit"]:
            continue
        said = f"K = {walk['k']:.4g} +- {walk['k_std_error'] or math.nan:.2g} of the drift model; K {stated(k)} of the Allan fit"
        if k["state"] == "limit" and walk["k"] > k["upper_limit"] or k["state"] == "withheld":
            yield said
        elif is_stated(k) and walk["k_std_error"]:
            if abs(walk["k"] - k["value"]) > 5 * math.hypot(walk["k_std_error"], k["std_error"]):
                yield said


def contradictions(channel, text):
    """Statements of one report that exclude each other."""
    yield from drift_contradictions(channel, text)
    tests, fitted, sentences = channel["tests"], channel["coefficients"]["input"] or {}, re.sub(r"\s+", " ", text)
    for stage, coefficients in channel["coefficients"].items():
        for term in "QNBKR" if coefficients and stage != "reduction_percent" else "":
            c = coefficients[term]
            if c["detected"] != is_stated(c) or c["value"] is not None and c["upper_limit"] is not None and \
                    c["value"] > c["upper_limit"]:
                yield f"{term} of {stage}: {stated(c)}, detected {c['detected']}, limit {c['upper_limit']}"
    cells = table_row(text)
    for term, cell in zip("QNBKR", cells if fitted else []):
        if cell != CELLS[fitted[term]["state"]]:
            yield f"{term}: \"{cell}\" in the table, {stated(fitted[term])} in JSON"
    unresolved = re.search(r"This record does not resolve ([A-Z, ]+):", sentences)
    for term in unresolved.group(1).split(", ") if unresolved else []:
        if is_stated(fitted[term]):
            yield f"\"does not resolve {term}\"; {term} = {stated(fitted[term])}"
    jarque_bera, ljung_box = tests["jarque_bera"], tests["ljung_box"]
    if jarque_bera and tests["normality"] == "normal" and jarque_bera["p_value"] < 1e-4:
        yield f"\"normal\"; Jarque-Bera p = {jarque_bera['p_value']:.1g}"
    if ljung_box and ljung_box["p_value"] < 1e-4 and "no autocorrelation is found" in sentences:
        yield f"\"no autocorrelation is found\"; Ljung-Box p = {ljung_box['p_value']:.1g}"


def analyze(program, options, seed, folder):
    """The only channel of the document of `run` and its report."""
    record, document = os.path.join(folder, "record.txt"), os.path.join(folder, "record.json")
    subprocess.run([program, "simulate", *shlex.split(options), "--seed", str(seed), "--output", record, "--force"], check=True)
    report = subprocess.run([program, "run", record, "--json", document, "--details", "--force"], check=True, capture_output=True,
                            text=True, encoding="utf-8").stdout
    with open(document, encoding="utf-8") as file:
        return json.load(file)["channels"][0], report


def errors(pairs, truth):
    """RMSE in percent and the share within one standard error, expected 68 %, of (value, standard error)."""
    if not truth or not pairs:
        return "-", "-"
    truth = float(truth)
    rmse = 100 * math.sqrt(sum((value / truth - 1) ** 2 for value, _ in pairs) / len(pairs))
    return f"{rmse:.2f}", f"{sum(abs(value - truth) <= error for value, error in pairs)}/{len(pairs)}"


def counted(terms):
    """Terms with the number of records: B2 K1."""
    return " ".join(f"{t}{terms.count(t)}" for t in "QNBKR" if t in terms) or "-"


def is_wrong(value, error, truth):
    """More than five standard errors and 10 percent off."""
    return abs(value - truth) > max(5 * error, 0.1 * truth)


def line(values):
    return " ".join(f"{v:>{w}}" if i else f"{v:<{w}}" for i, (v, w) in enumerate(zip(values, WIDTHS))).rstrip()


def examine(row, program, records, folder):
    """Prints a row; returns what is wrong in words: verdicts, values, contradictions."""
    false, missed, verdicts, values, found, pairs = [], [], [], [], [], {"N": [], "B": [], "K": []}
    for seed in range(1, records + 1):
        channel, report = analyze(program, row["options"], seed, folder)
        coefficients = best(channel)
        terms = [t for t in "QNBKR" if coefficients and is_stated(coefficients[t])]
        false += [t for t in terms if t not in row["terms"]]
        missed += [t for t in row["terms"] if t not in terms]
        for term in pairs:
            if term not in terms or not row[term]:
                continue
            pairs[term].append((coefficients[term]["value"], coefficients[term]["std_error"]))
            if is_wrong(*pairs[term][-1], float(row[term])):
                values.append(f"{row['name']}, seed {seed}: {term} = {stated(coefficients[term])} instead of {row[term]}")
        if channel["verdict"]["drift"] not in row["verdict"].split("|"):
            verdicts.append(f"{row['name']}, seed {seed}: verdict {channel['verdict']['drift']}")
        found += [f"{row['name']}, seed {seed}: {what}" for what in contradictions(channel, report)]
    print(line([row["name"], records, counted(false), counted(missed), len(verdicts), *errors(pairs["N"], row["N"]),
                *errors(pairs["B"], row["B"]), len(found)]), flush=True)
    return verdicts, values, found


def main():
    table, program, records = sys.argv[1:]
    wrong = {"Verdicts that are wrong": [], "Values that are wrong": [], "Contradictions": []}
    print(line(HEAD), line(SECOND), sep="\n")
    with open(table, newline="", encoding="utf-8") as file, tempfile.TemporaryDirectory() as folder:
        for row in csv.DictReader(file):
            for texts, more in zip(wrong.values(), examine(row, program, int(records), folder)):
                texts += more
    for title, texts in wrong.items():
        print(f"\n{title}: {len(texts)}", *("  " + text for text in texts), sep="\n")


if __name__ == "__main__":
    main()
