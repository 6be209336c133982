"""Orders 1 to 6 of each preset's error, as every command has them: ``python -m tests.hardware_causes.orders``."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from scenarios.commands.protocol import Protocol
from scenarios.studies.design.field import Designs, errors_deg
from tests.command_line import halltwin
from twin.angles import Array, wrap_deg
from twin.chain import Chain
from twin.hardware import run
from twin.presets import preset_names, read_preset
from twin.sweep import Sweep

POINTS, TURNS = 360, 20
LAST = 6


def orders(error_deg: Array) -> Array:
    """Amplitudes (LAST,) [deg] of the orders 1 and up of an error (turns * points,) over whole turns."""
    turns = error_deg.reshape(-1, error_deg.size) if error_deg.ndim == 1 else error_deg
    count = turns.shape[-1]
    whole = np.mean(turns, axis=0)
    spectrum = np.fft.rfft(whole) * 2.0 / count
    return np.abs(spectrum[1 : LAST + 1])


def of_expected(chain: Chain) -> Array:
    """Of the expected reading, without noise and words."""
    smooth = chain.without("cordic_truncation", "output_quantisation")
    return orders(np.degrees(smooth.error(Protocol(points=POINTS).motion())))


def of_simulate(chain: Chain, *, turns: int = TURNS) -> Array:
    """Of sweeps as ``simulate`` records them, the mean of several."""
    motion = Protocol(points=POINTS).motion()
    sweeps = [chain.simulate(motion, seed=seed) for seed in range(turns)]
    return orders(np.stack([_error_deg(chain, one) for one in sweeps]))


def of_hardware(chain: Chain, *, turns: int = TURNS) -> Array:
    """Of the words that ``hardware`` receives, the mean of several runs."""
    motion = Protocol(points=POINTS).motion()
    slope = chain.sensor_sense * chain.output_sense
    received = [np.degrees(run(chain, motion, np.random.default_rng(seed)).received_rad) for seed in range(turns)]
    return orders(np.stack([wrap_deg(one - slope * np.degrees(motion.shaft_rad)) for one in received]))


def of_design(chain: Chain) -> Array | None:
    """Of the design whose magnet and place are the preset's own; None without a magnet."""
    if chain.magnet is None:
        return None
    smooth = chain.without("cordic_truncation", "output_quantisation")
    designs = Designs(chain.magnet.magnet, chain.magnet.placement)
    return orders(errors_deg(smooth, designs, Protocol(points=POINTS).motion())[0])


def of_bench(name: str, folder: Path) -> Array:
    """Of a sweep that ``bench`` measures over the virtual bus."""
    path = folder / f"{name}.csv"
    halltwin("bench", "--twin", name, "-o", str(path), "--points", str(POINTS))
    return orders(_error_deg(read_preset(name), Sweep.read(path)))


def _error_deg(chain: Chain, sweep: Sweep) -> Array:
    slope = chain.sensor_sense * chain.output_sense
    return wrap_deg(sweep.measured_deg - slope * sweep.reference_deg)


def main() -> None:
    """Print the table."""
    table = Table("preset", "from", *(f"order {order}" for order in range(1, LAST + 1)), title="error [deg]")
    with tempfile.TemporaryDirectory() as folder:
        for name in preset_names():
            chain = read_preset(name)
            rows = {
                "expected": of_expected(chain),
                "simulate": of_simulate(chain),
                "hardware": of_hardware(chain),
                "design": of_design(chain),
                "bench (one turn)": of_bench(name, Path(folder)),
            }
            for source, found in rows.items():
                if found is not None:
                    table.add_row(name, source, *(f"{value:.4f}" for value in found))
    Console(width=110).print(table)


if __name__ == "__main__":
    main()
