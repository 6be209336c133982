"""The C correction: largest difference from Python, and cycles a call: ``python -m tests.benchmarks.c_header``."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from diagnosis.correction.compensation import Correction, correction_of
from diagnosis.correction.compensation_c import header
from tests.diagnosis.error_model.study import device
from twin.angles import TAU, wrap
from twin.chain import Chain

PROGRAM = """
#include <stdio.h>
#include <stdlib.h>
#include <inttypes.h>
#include <time.h>
#include "correction.h"
#if defined(__x86_64__) || defined(__i386__)
#include <x86intrin.h>
#define TICKS() __rdtsc()
#else
#define TICKS() 0
#endif
int main(int count, char **given)
{
    const uint32_t calls = 20000000u;
    uint32_t word = 1, k;
    struct timespec a, b;
    uint64_t from, to;
    if (count > 1) {
        for (k = 0; k < (uint32_t)atoi(given[1]); ++k, word = word * 1664525u + 1013904223u)
            printf("%" PRIu32 " %" PRIu32 "\\n", word, halltwin_correct(word));
        return 0;
    }
    clock_gettime(CLOCK_MONOTONIC, &a);
    from = TICKS();
    for (k = 0; k < calls; ++k)
        word = halltwin_correct(word + k * 2654435761u);
    to = TICKS();
    clock_gettime(CLOCK_MONOTONIC, &b);
    printf("%.2f %.1f %u\\n", ((b.tv_sec - a.tv_sec) * 1e9 + (b.tv_nsec - a.tv_nsec)) / calls,
           (double)(to - from) / calls, word & 1u);
    return 0;
}
"""


def measured(correction: Correction, compiler: str) -> tuple[float, float, float]:
    """Largest difference from Python [deg], ns a call, cycles a call (time stamp counter; 0 where there is none)."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "correction.h").write_text(header(correction, source="benchmark"))
        (folder / "program.c").write_text(PROGRAM)
        subprocess.run([compiler, "-std=gnu99", "-O2", "-o", "program", "program.c"], cwd=folder, check=True)
        table = subprocess.run(["./program", "200000"], cwd=folder, capture_output=True, text=True, check=True).stdout
        words = np.array(table.split(), dtype=np.float64).reshape(-1, 2) / 2.0**32 * TAU
        times = subprocess.run(["./program"], cwd=folder, capture_output=True, text=True, check=True).stdout.split()
    difference = np.max(np.abs(wrap(words[:, 1] - correction.shaft(words[:, 0]))))
    return float(np.degrees(difference)), float(times[0]), float(times[1])


def main() -> None:
    """Measure a correction of the paper's device a and one with many orders."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        print("no C compiler here")
        return
    strong = Chain().with_effect("gain_mismatch", ratio=1.19).with_effect("saturation", k_percent=2.0)
    for name, chain in (("Table 2, device a", device("a")), ("gain ratio 1.19, saturation 2 %", strong)):
        correction = correction_of(chain)
        difference, ns, cycles = measured(correction, compiler)
        print(
            f"{name:34} {correction.series.shape[1]:2d} orders   C against Python at most {difference:.1e} deg   "
            f"{ns:.1f} ns, {cycles:.0f} cycles a call"
        )


if __name__ == "__main__":
    main()
