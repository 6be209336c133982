"""The C header, compiled and run on words."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from twin.angles import Array, IntArray

_PROGRAM = """
#include <stdio.h>
#include <inttypes.h>
#include "correction.h"
int main(void)
{
    uint32_t word;
    int32_t mC;
    while (scanf("%" SCNu32 " %" SCNd32, &word, &mC) == 2)
        printf("%" PRIu32 " %u\\n", TEST(correct, word), (unsigned)TEST(correct_u16, (uint16_t)(word >> 16)));
    return 0;
}
"""
_CALLS = {
    True: "#define TEST(name, word) test_##name(word, mC)\n",
    False: "#define TEST(name, word) ((void)mC, test_##name(word))\n",
}


def run_header(text: str, words: Array, folder: Path, temperature_mc: IntArray | None = None) -> Array:
    """Results (n, 2) of the compiled 32-bit and 16-bit functions, with the prefix test, at the words (n,)."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        pytest.skip("no C compiler here: the header is not compiled")
    (folder / "correction.h").write_text(text)
    (folder / "program.c").write_text(_CALLS[temperature_mc is not None] + _PROGRAM)
    strict = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-pedantic"]
    subprocess.run([compiler, *strict, "-o", "program", "program.c"], cwd=folder, check=True)
    warmth = np.zeros(words.size, dtype=np.int64) if temperature_mc is None else temperature_mc
    lines = "\n".join(f"{int(word)} {int(mc)}" for word, mc in zip(words, warmth, strict=True))
    out = subprocess.run(["./program"], cwd=folder, input=lines, capture_output=True, text=True, check=True).stdout
    return np.array([line.split() for line in out.splitlines()], dtype=np.float64)
