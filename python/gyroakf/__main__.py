# SPDX-License-Identifier: MIT
"""The program, also for files that Python's libraries read: ``python -m gyroakf run flight.mcap``.

Of those ``--topic NAME`` and ``--instance N`` choose what is read.
"""

import os
import subprocess
import sys
import tempfile

from ._errors import GyroakfError
from ._formats import as_csv, reader_of
from ._library import program


def main() -> int:
    chosen = {"topic": None, "instance": "0"}
    arguments = []
    words = iter(sys.argv[1:])
    for word in words:
        if word.startswith("--") and word[2:] in chosen:
            chosen[word[2:]] = next(words, None)
        else:
            arguments.append(word)
    with tempfile.TemporaryDirectory() as folder:
        for i, word in enumerate(arguments):
            reader = reader_of(word)
            if reader:
                name = os.path.join(folder, os.path.basename(word.rstrip("/")) + ".csv")
                with open(name, "wb") as file:
                    file.write(as_csv(word, reader, chosen["topic"], int(chosen["instance"] or 0)))
                arguments[i] = name
        return subprocess.call([program(), *arguments])


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (GyroakfError, ValueError) as error:
        sys.exit(f"gyroakf: error: {error}")
