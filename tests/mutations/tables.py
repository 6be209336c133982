"""All mutations: those written by hand and those made from tables."""

from __future__ import annotations

from tests.mutations.beside import BESIDE
from tests.mutations.by_hand import BY_HAND
from tests.mutations.discovery import DISCOVERY
from tests.mutations.export import EXPORT
from tests.mutations.files import FILES
from tests.mutations.fleet import FLEET
from tests.mutations.forms import FORMS
from tests.mutations.gaps import GAPS
from tests.mutations.lab import LAB
from tests.mutations.logs import LOGS
from tests.mutations.long import LONG
from tests.mutations.mutation import Mutation
from tests.mutations.noise import NOISE
from tests.mutations.pace import PACE
from tests.mutations.paper import PAPER
from tests.mutations.parts import PARTS
from tests.mutations.periods import PERIODS
from tests.mutations.reported import REPORTED
from tests.mutations.scripts import SCRIPTS
from tests.mutations.settings import settings
from tests.mutations.setups import SETUPS
from tests.mutations.signs import signs
from tests.mutations.spared import SPARED
from tests.mutations.spins import SPINS
from tests.mutations.stages import STAGES
from tests.mutations.studies import STUDIES
from tests.mutations.thermal import THERMAL
from tests.mutations.words import WORDS


def mutations() -> tuple[Mutation, ...]:
    """Every mutation, those by hand first."""
    return (
        *BY_HAND,
        *GAPS,
        *NOISE,
        *DISCOVERY,
        *STAGES,
        *PERIODS,
        *PAPER,
        *BESIDE,
        *PARTS,
        *FORMS,
        *FILES,
        *EXPORT,
        *LOGS,
        *STUDIES,
        *LAB,
        *LONG,
        *FLEET,
        *SCRIPTS,
        *THERMAL,
        *REPORTED,
        *WORDS,
        *SETUPS,
        *PACE,
        *SPARED,
        *SPINS,
        *settings(),
        *signs(),
    )
