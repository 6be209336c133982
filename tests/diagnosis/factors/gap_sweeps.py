"""Sweeps at several air gaps with a known truth, from magpylib's field and without any code of the twin or the fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
TAU = 2.0 * np.pi


@dataclass(frozen=True, kw_only=True)
class Truth:
    """One sensor before one magnet; displacements x + iy in mm, fields and voltages in mT."""

    sensor: complex = 0j
    magnet: complex = 0j
    gain: float = 1.0
    beta: float = 0.0
    voltage: complex = 0j
    stray: complex = 0j
    tilt: complex = 0j
    """Of the sensor in deg: towards where its normal leans."""
    magnet_tilt: complex = 0j
    """Of the magnet about its centre in deg: towards where its axis leans at a = 0."""
    eccentric_rad: float = 0.0
    quad_per_mT: float = 0.0
    diameter_mm: float = 6.0
    height_mm: float = 2.5

    def sweep(
        self, gap_mm: float, rng: np.random.Generator, *, noise_deg: float = 0.02, n: int = 360, channels: bool = True
    ) -> dict[str, Array]:
        """The columns of one turn at one air gap."""
        theta = TAU * np.arange(n) / n
        field = self.field_mT(theta + 0.4, gap_mm)
        sensed = self.axes @ (field + np.array([[self.stray.real], [self.stray.imag], [0.0]]))
        along, across = sensed[0], sensed[1] * np.cos(self.beta) + sensed[0] * np.sin(self.beta)
        x = along + self.quad_per_mT * along**2 + self.voltage.real
        y = self.gain * (across + self.quad_per_mT * across**2 + self.voltage.imag)
        read = np.arctan2(y, x) + np.radians(noise_deg) * rng.standard_normal(n)
        reference = theta + self.eccentric_rad * np.cos(theta)
        columns = {"reference_deg": np.degrees(reference), "measured_deg": np.degrees(read)}
        if not channels:
            return columns
        # Ten millivolts a millitesla, and a ten-thousandth of noise.
        noise = 1e-4 * np.max(np.abs(x)) * rng.standard_normal((2, n))
        return {**columns, "vx": 10.0 * (x + noise[0]), "vy": 10.0 * (y + noise[1])}

    @property
    def axes(self) -> Array:
        """The sensor's axes as rows, turned so that its normal leans by the tilt."""
        return _leaning(self.tilt).T

    def field_mT(self, angle_rad: Array, gap_mm: float) -> Array:
        """The field (3, n) at the sensor while the magnet turns by the angle, its centre going round with it."""
        import magpylib

        body = magpylib.magnet.Cylinder(polarization=(-1.21, 0.0, 0.0), dimension=(self.diameter_mm, self.height_mm))
        seen = self.sensor * np.exp(-1j * angle_rad) - self.magnet
        height = np.full(angle_rad.size, gap_mm + 0.5 * self.height_mm)
        axes = _leaning(self.magnet_tilt)
        own = 1e3 * body.getB(np.stack([seen.real, seen.imag, height], axis=-1) @ axes).reshape(-1, 3) @ axes.T
        plane = (own[:, 0] + 1j * own[:, 1]) * np.exp(1j * angle_rad)
        return np.stack([plane.real, plane.imag, own[:, 2]])


def _leaning(tilt_deg: complex) -> Array:
    """Columns: axes that were turned until their third leans by this tilt."""
    from scipy.spatial.transform import Rotation

    # Leaning towards x is a turn about y; towards y, backwards about x.
    return Rotation.from_rotvec([-tilt_deg.imag, tilt_deg.real, 0.0], degrees=True).as_matrix()


CASES: dict[str, tuple[Truth, frozenset[str]]] = {
    "nothing": (Truth(), frozenset()),
    "electronics": (
        Truth(gain=1.006, beta=0.004, voltage=0.4 - 0.3j),
        frozenset({"voltage", "electronics"}),
    ),
    "stray field": (Truth(stray=0.5 - 0.3j), frozenset({"voltage"})),
    "sensor": (Truth(sensor=0.6 + 0.3j), frozenset({"sensor"})),
    "sensor, a little": (Truth(sensor=0.15 + 0.1j), frozenset({"sensor"})),
    "sensor and electronics": (
        Truth(sensor=0.6 + 0.3j, gain=1.006, beta=0.004),
        frozenset({"sensor", "electronics"}),
    ),
    "sensor, magnet and electronics": (
        Truth(sensor=0.6 + 0.3j, magnet=0.1 - 0.25j, gain=1.006, beta=0.004, voltage=0.3 - 0.2j),
        frozenset({"voltage", "electronics", "sensor", "magnet"}),
    ),
    "sensor off and tilted": (Truth(sensor=0.4 + 0.2j, tilt=2.0 + 1.0j), frozenset({"sensor", "tilt"})),
    "sensor and magnet": (Truth(sensor=0.6 + 0.3j, magnet=0.1 - 0.25j), frozenset({"sensor", "magnet"})),
    "sensor and tilted magnet": (
        Truth(sensor=0.6 + 0.3j, magnet_tilt=2.0 - 1.5j),
        frozenset({"sensor", "magnet_tilt"}),
    ),
    "sensor, tilted magnet and voltage": (
        Truth(sensor=0.6 + 0.3j, magnet_tilt=-1.0 + 3.0j, voltage=0.3 - 0.2j),
        frozenset({"voltage", "sensor", "magnet_tilt"}),
    ),
    "sensor tilted on the axis": (Truth(tilt=4.0 + 2.0j), frozenset({"electronics"})),
    "tilted on the axis, magnet off": (
        Truth(tilt=4.0 + 2.0j, magnet=0.3 - 0.2j),
        frozenset({"electronics", "tilt_and_magnet"}),
    ),
    "both tilted on the axis": (
        Truth(tilt=4.0 + 2.0j, magnet_tilt=3.0 - 1.0j),
        frozenset({"electronics", "both_tilts"}),
    ),
    "tilted magnet alone": (Truth(magnet_tilt=3.0 + 2.0j), frozenset()),
    "magnet alone": (Truth(magnet=0.3 + 0.2j), frozenset()),
    "eccentric reference": (Truth(eccentric_rad=0.004), frozenset({"reference"})),
}
"""What is wrong, and the causes that may be named for it."""
OPEN = frozenset({"electronics", "tilt"})
"""Of these, beside a sensor off the axis, three gaps need not tell which it is: then neither is named."""
