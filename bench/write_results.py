# SPDX-License-Identifier: MIT
"""Writes results.md of what the parts printed into build/PART.log: write_results.py PART..."""
import os
import platform
import subprocess
import sys
from pathlib import Path

PEERS = ("numpy", "scipy", "allantools", "pandas", "polars", "statsmodels", "filterpy")


def said(*command):
    """First line of what a command prints; nothing where there is none."""
    try:
        lines = subprocess.run(command, capture_output=True, text=True, timeout=60).stdout.splitlines()
    except (OSError, subprocess.TimeoutExpired):
        lines = []
    return lines[0].strip() if lines else ""


def cpu():
    for line in said_all("lscpu"):
        if line.startswith("Model name:"):
            return line.split(":", 1)[1].strip()
    return platform.machine()


def said_all(*command):
    try:
        return subprocess.run(command, capture_output=True, text=True, timeout=60).stdout.splitlines()
    except OSError:
        return []


def machine():
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    cache = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "gyroakf" / "bench" / "bin" / "python"
    ask = "import importlib.metadata as m\nfor p in %r:\n try: print(p, m.version(p), end=', ')\n except Exception: pass" % (PEERS,)
    return [
        f"Machine: {os.cpu_count()} processors {cpu()}, {memory:.0f} GB; {platform.system()} {platform.release().split('-')[0]}",
        f"Compiler: {said('gfortran', '--version')}; flags as `setup.sh` sets them",
        f"gyroakf {said('git', 'describe', '--always', '--dirty', '--exclude=*')}, peers: "
        f"{said(str(cache), '-c', ask).rstrip(', ') or 'none'}",
    ]


def judged(value, target):
    """met, missed, or nothing where there is no figure to reach."""
    words = target.split()
    if len(words) != 2:
        return ""
    number, limit = float(value.split()[0]), float(words[1])
    return "met" if (number >= limit if words[0] == ">=" else number <= limit) else "**missed**"


def main():
    build, rows, texts, failures = Path("build"), [], [], []
    for part in sys.argv[1:]:
        log = build / f"{part}.log"
        if not log.is_file():
            failures.append(f"{part}: not measured")
            continue
        lines = log.read_text(errors="replace").splitlines()
        for line in lines:
            if line.startswith("figure: "):
                what, value, target = (field.strip() for field in line[len("figure: "):].split("|"))
                rows.append((part, what, value, target, judged(value, target)))
            elif line.startswith("FAILED: "):
                failures.append(f"{part}: failed, see below")
        texts += ["", f"## {part}", "", "```", *(line for line in lines if not line.startswith("figure: ")), "```"]
    count = [sum(row[4] == word for row in rows) for word in ("met", "**missed**")]
    text = ["# Speed and memory", "",
            "Written by `bench/all.sh`, which measures again. Times are medians, memory is what the kernel counts for the process;",
            "each part says how busy the machine was.", "", *(f"- {line}" for line in machine()), "",
            f"{count[0]} figures met, {count[1]} missed.", *(f"- {failure}" for failure in failures), "",
            "| part | what | measured | to reach | |", "|---|---|---|---|---|",
            *("| " + " | ".join(field.replace("|", "/") for field in row) + " |" for row in rows), *texts]
    Path("results.md").write_text("\n".join(line.rstrip() for line in text) + "\n")


main()
