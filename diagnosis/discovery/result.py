"""The answer of a discovery: what stands when the last stage has spoken."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.observations import of_readings
from diagnosis.discovery.proof.alone import Alone
from diagnosis.discovery.proof.changes import Change
from diagnosis.discovery.proof.cross_validation import rms_deg
from diagnosis.discovery.proof.lack_of_fit import LackOfFit
from diagnosis.discovery.proof.misfit import Misfit, misfits
from diagnosis.discovery.proof.predictive_check import PredictiveCheck
from diagnosis.discovery.proof.whole_recordings import are_halves
from diagnosis.discovery.state import State
from diagnosis.discovery.watch import EndedBy
from twin.angles import Array
from twin.catalogue import unnamed
from twin.chain import Chain
from twin.each_recording import device_of, everywhere
from twin.effect import BoolArray, Parameters
from twin.moved_placement import settled
from twin.sweep import Sweep

REPEATED, HELD_OUT = "repeated readings", "held-out readings"
"""What the noise floor was taken from: their scatter at one angle; without such, what the extended twin leaves."""


@dataclass(frozen=True, eq=False)
class Discovery:
    """The answer to a sweep.

    ``baseline`` is the paper's error model alone, ``fit`` the extended one; ``masked`` the raw rows (n_raw,) that
    belong to single-reading causes; ``invisible`` the effects that this sweep cannot show, with what it lacks;
    ``cut_short`` the stage in which the search was stopped, where it was, and ``cut_by`` what did it; ``misfits``
    what the extended twin does not predict although neither a cause nor structure tells of it. ``changed`` are the
    parameters of a given twin that have moved, ``other_device`` whether so many have that it is another device's,
    ``fitted_anew`` whether the others were not held at the twin's values. ``in_factors`` are effects that an angle
    alone never tells from the error model's factors, which hold what they do. ``rival_fits`` are the fits with
    another effect, whose name stands beside, in the place of a cause, ``fits_beside`` those with one that a cause
    hides, and how likely that is against none. ``alone`` is each of several recordings
    fitted by itself, and ``whole_recordings`` whether these were held out as a whole. ``words`` are the effects on
    the words as they were sent: ``sweep`` holds the readings without them, ``fit`` is of these, and the device has
    them; ``told_back`` (n,) [rad] is what readings that were told back had been off by, None where none was.
    """

    sweep: Sweep
    baseline: Fit
    fit: Fit
    causes: tuple[Finding, ...]
    masked: BoolArray
    bits: float | None
    baseline_held_deg: float
    extended_held_deg: float
    noise_floor_deg: float
    noise_floor_from: str
    looked_at: int
    given: Chain | None = None
    changed: tuple[Change, ...] = ()
    other_device: bool = False
    fitted_anew: bool = False
    invisible: dict[str, tuple[str, ...]] = field(default_factory=dict)
    in_factors: tuple[str, ...] = ()
    likeness: PredictiveCheck | None = None
    lack: LackOfFit | None = None
    misfits: tuple[Misfit, ...] = ()
    cut_short: str | None = None
    cut_by: EndedBy | None = None
    alone: tuple[Alone, ...] = ()
    rival_fits: tuple[tuple[str, Fit], ...] = ()
    fits_beside: tuple[tuple[str, Fit, float], ...] = ()
    whole_recordings: bool = False
    words: Mapping[str, Parameters] = field(default_factory=dict)
    told_back: Array | None = None

    def __repr__(self) -> str:
        names = ", ".join(cause.name for cause in self.causes) or "no cause"
        held = f"held-out RMS {self.baseline_held_deg:.4g} -> {self.extended_held_deg:.4g} deg"
        return f"Discovery({self.sweep.name!r}, {self.verdict}: {names}; {held})"

    @classmethod
    def of(cls, state: State) -> Discovery:
        """The answer that a state holds after the last stage."""
        fit, observations = state.fit, state.fit.observations
        # What the answer hands on as a twin is a twin that every command takes.
        if (limited := fit.chain.within_limits()) is not fit.chain:
            fit = replace(fit, chain=limited)
        held = [of_readings(rms_deg(residual, observations.usable), observations) for residual in state.held_out]
        provides = observations.motion.provides
        return cls(
            sweep=state.sweep,
            baseline=state.baseline or fit,
            fit=fit,
            causes=state.causes,
            masked=state.touched,
            bits=state.bits,
            baseline_held_deg=held[0],
            extended_held_deg=held[1],
            noise_floor_deg=float(np.degrees(observations.repeat_rms)) if observations.repeat_rms else held[1],
            noise_floor_from=REPEATED if observations.repeat_rms else HELD_OUT,
            looked_at=state.looked_at,
            given=state.given,
            changed=state.changed,
            other_device=state.other_device,
            fitted_anew=state.fitted_anew,
            invisible={
                everywhere(effect.name): effect.missing(provides)
                for effect in state.effects
                if not unnamed(effect.name) and not effect.visible_in(provides)
            },
            in_factors=tuple(
                sorted(
                    everywhere(e.name)
                    for e in state.effects
                    # No factor of the error model is a wave in time.
                    if not e.visible_in(provides) and e.acts_in(provides) and (e.line is None or e.line.clock != "time")
                )
            ),
            likeness=state.likeness,
            lack=state.lack,
            misfits=misfits(fit, state.likeness, state.lack),
            cut_short=state.watch.stopped_in,
            cut_by=state.watch.ended_by,
            alone=state.alone,
            rival_fits=state.rival_fits,
            fits_beside=state.fits_beside,
            words=state.words,
            told_back=state.told_back,
            whole_recordings=state.fold is not None and are_halves(fit, state.fold),
        )

    @property
    def device(self) -> Chain:
        """The extended twin as it is in a single recording: of several, in the first one's."""
        return settled(device_of(self.fit.chain)).with_values(self.words)

    @property
    def _turn_contradicted(self) -> bool:
        recordings = self.sweep.recordings
        return recordings is not None and any(setup.turn_contradicted for setup in recordings.setups)

    @property
    def verdict(self) -> str:
        """adequate, explained, partly explained or unnamed; stopped where the search was before it found anything.

        Explained is only what leaves no structure, is no misfit, was searched to the end, and comes of recordings none
        of whose stated turns of the sensor the zero contradicts: whether a cause rests on that turn is not asked.
        """
        named = bool(self.changed) or self.fitted_anew or any(cause.name != "unnamed" for cause in self.causes)
        without_name = any(cause.name == "unnamed" for cause in self.causes)
        open_still = without_name or bool(self.misfits)
        if named:
            left = open_still or self.cut_short is not None or self._turn_contradicted
            return "partly explained" if left else "explained"
        if self.cut_short is not None and not without_name:
            return "stopped"
        return "unnamed" if open_still else "adequate"
