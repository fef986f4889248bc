# SPDX-License-Identifier: MIT
"""Converts R data files into CSV with a header: convert.py TABLE DIR FOLDER.

Every recording of TABLE with conversion `rda` found below DIR becomes FOLDER/NAME.csv; existing files are kept.
"""
import os
import sys
import warnings

import numpy
import rdata

from compare import converted_path, find, recordings

warnings.simplefilter("ignore")  # rdata: no constructor for the R classes "imu" and "matrix"


def main():
    table, folder, target = sys.argv[1:]
    os.makedirs(target, exist_ok=True)
    for path, conversion in dict.fromkeys((key[1], key[2]) for key in recordings(table)):
        source, output = find(folder, path), converted_path(target, path)
        if conversion != "rda" or source is None or os.path.exists(output):
            continue
        (matrix,) = rdata.read_rda(source).values()
        names = [str(name).lower().replace(". ", "_") for name in matrix.coords["dim_1"].values]
        # 17 digits restore every double; quantized data have shorter decimal forms
        rounded = numpy.round(matrix.values, 8)
        digits = "%.10g" if numpy.allclose(matrix.values, rounded, rtol=0, atol=1e-14) else "%.17g"
        numpy.savetxt(output + ".part", matrix.values, fmt=digits, delimiter=",", header=",".join(names), comments="")
        os.replace(output + ".part", output)


if __name__ == "__main__":
    main()
