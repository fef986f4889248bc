#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Breaks the library in many small ways, one after the other, and shows that the tests notice.

    ci/mutation/run.py             all mutants of ci/mutation/mutants
    ci/mutation/run.py NAME...     these
    ci/mutation/run.py --named [NAME...]   with no other tests than those that each mutant names
    ci/mutation/run.py --check     only whether the text of every mutant is still there, exactly once (a second)

Works in a copy of the tree, build/mutation, which is kept: a second run builds only what changed. Of each mutant the
tests that it names run first; where they pass, all suites, the tests of the C interface and those of the command line.
One line a mutant; the last line is "N caught of M". Exit code 0: at least 95 % are caught; 1: fewer; 2: the list does
not fit the sources, a mutant does not compile, or the tests of the unbroken library fail.
"""
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TREE = ROOT / "build" / "mutation"
LEAST_SHARE = 0.95
LONGEST = 1800  # seconds that a test may take: a mutant may make it run for ever


class Mutant:
    """A change of one text in one file: name, file, tests that should see it, the text and what takes its place."""

    def __init__(self, heading, where):
        parts = [part.strip() for part in heading.split("|")]
        if len(parts) != 3 or not all(parts):
            give_up(f"{where}: a mutant begins with 'NAME | FILE | TEST...'")
        self.name, self.file, self.where = parts[0], parts[1], where
        self.tests = parts[2].split()
        self.old, self.new = [], []

    def applied(self):
        """The text of the file with the change; None and the reason where that is not possible."""
        path = ROOT / self.file
        if not path.is_file():
            return None, f"there is no {self.file}"
        old, new, text = "\n".join(self.old), "\n".join(self.new), path.read_text()
        if not old or old == new:
            return None, "it changes nothing"
        if text.count(old) != 1:
            return None, f"its text stands {text.count(old)} times in {self.file}"
        return text.replace(old, new), None


def give_up(reason):
    sys.exit(print(f"mutation: {reason}", file=sys.stderr, flush=True) or 2)


def read_mutants():
    """Blocks of a heading, lines '- OLD' and lines '+ NEW'; '#' begins a comment."""
    mutants, path = [], Path(__file__).with_name("mutants")
    for number, line in enumerate(path.read_text().splitlines(), 1):
        where = f"{path.name}:{number}"
        if not line.strip() or line.startswith("#"):
            continue
        if line[:2] not in ("- ", "+ "):
            mutants.append(Mutant(line, where))
        elif not mutants:
            give_up(f"{where}: a text before the first heading")
        else:
            (mutants[-1].old if line[0] == "-" else mutants[-1].new).append(line[2:])
    names = [mutant.name for mutant in mutants]
    wrong = [f"{m.where}: {m.name}: {reason}" for m in mutants for reason in [m.applied()[1]] if reason]
    wrong += [f"the name {name} is given twice" for name in sorted(set(names)) if names.count(name) > 1]
    if wrong:
        give_up("the list does not fit the sources:\n  " + "\n  ".join(wrong))
    return mutants


def copy_tree():
    """Brings the copy up to date; files that did not change keep their time, so that they are not built again."""
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT,
                            check=True, capture_output=True, text=True).stdout.split("\0")
    wanted = {name for name in listed if name and (ROOT / name).is_file()}
    for name in wanted:
        source, target = ROOT / name, TREE / name
        if target.is_file() and target.read_bytes() == source.read_bytes():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(source.read_bytes())
        target.chmod(source.stat().st_mode)
    for folder in ("src", "app", "test", "c_api"):
        for path in (TREE / folder).rglob("*"):
            if path.is_file() and str(path.relative_to(TREE)) not in wanted:
                path.unlink()


def run(command, seconds=None):
    """Exit code and output of a command in the copy; 'timeout' as the code where it does not end."""
    try:
        done = subprocess.run(command, cwd=TREE, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, errors="replace", timeout=seconds)
    except subprocess.TimeoutExpired as late:
        return "timeout", (late.stdout or b"").decode(errors="replace")
    return done.returncode, done.stdout


def build():
    """Builds the copy by CMake, which compiles again what uses a module only where its interface changes: the paths of
    the programs, or None and what the compiler said."""
    os.environ["GYROAKF_CMAKE"] = "1"
    code, output = run(["ci/cmake.sh", "--only", "gyroakf_program test_main test_c_api"])
    folder = TREE / "build" / "cmake" / "shared"
    programs = {name: folder / "test" / name for name in ("test_main", "test_c_api")} | {"gyroakf": folder / "gyroakf"}
    return (programs if code == 0 else None), output


def command_of(test, programs):
    """Words that run a test: a suite, c_api, cli:PART; all suites ('all'), every part ('cli')."""
    if test == "c_api":
        return [str(programs["test_c_api"])]
    if test.split(":")[0] == "cli":
        return ["test/cli/run.sh", str(programs["gyroakf"]), *test.split(":")[1:]]
    return [str(programs["test_main"])] + ([] if test == "all" else [test])


def failure(test, programs):
    """What fails in a test, '' where nothing does."""
    code, output = run(command_of(test, programs), LONGEST)
    if code == 0:
        return ""
    if code == "timeout":
        return f"{test}: does not end"
    if code < 0:
        return f"{test}: signal {-code}"
    suite, found = test, re.search(r"^ *\.\.\. (.+) \[FAILED\]", output, re.M)
    if test == "all" and found:
        suite = re.findall(r"^# Testing: (\w+)", output[:found.start()], re.M)[-1]
    if not found:
        found = re.search(r"^FAILED: ([^:\n]*)|^([^\n]*:\d+: [^\n]*)", output, re.M)
    what = next((group for group in found.groups() if group), "") if found else f"exit code {code}"
    return f"{suite}: {what}"


def caught_by(mutant, programs, others):
    """The first test that fails, of those that it names and of others; '' for a survivor."""
    for test in mutant.tests:
        seen = failure(test, programs)
        if seen:
            return seen
    for test in others:
        seen = failure(test, programs)
        if seen:
            return f"{seen} (not named)"
    return ""


def try_mutant(mutant, others):
    """Breaks the copy, builds and tests it, mends it."""
    target = TREE / mutant.file
    sound = target.read_text()
    target.write_text(mutant.applied()[0])
    try:
        programs, said = build()
        if not programs:
            give_up(f"{mutant.name} does not compile, and so is no mutant:\n" + said[-3000:])
        return caught_by(mutant, programs, others)
    finally:
        target.write_text(sound)


def check_sound(mutants):
    """The unbroken library passes the tests that are used, or nothing can be told."""
    programs, said = build()
    if not programs:
        give_up("the library does not build:\n" + said[-3000:])
    for test in sorted({test for mutant in mutants for test in mutant.tests}):
        seen = failure(test, programs)
        if seen:
            give_up(f"the library is not broken, and a test fails: {seen}")


def main():
    mutants, words = read_mutants(), sys.argv[1:]
    if words == ["--check"]:
        print(f"{len(mutants)} mutants fit the sources")
        return
    others = ("all", "c_api", "cli")
    if words[:1] == ["--named"]:
        others, words = (), words[1:]
    unknown = set(words) - {mutant.name for mutant in mutants}
    if unknown:
        give_up("no such mutant: " + " ".join(sorted(unknown)))
    mutants = [mutant for mutant in mutants if not words or mutant.name in words]
    copy_tree()
    check_sound(mutants)
    width = max(len(mutant.name) for mutant in mutants)
    survivors = []
    for mutant in mutants:
        seen = try_mutant(mutant, others)
        if not seen:
            survivors.append(mutant)
        print(f"{mutant.name:{width}}  {mutant.file[len('src/gyroakf/'):]:32}  {seen or 'SURVIVED'}", flush=True)
    caught = len(mutants) - len(survivors)
    print(f"{caught} caught of {len(mutants)}")
    sys.exit(0 if caught >= LEAST_SHARE * len(mutants) else 1)


main()
