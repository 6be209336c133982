"""The bench's messages: CAN frames to names and physical values and back, by the packaged DBC file.

Every frame ends in a checksum; frames of nodes carry a rolling counter beside it (see the comments in halltwin.dbc).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

import can

from twin.link.frames import CRC8_FINAL, CRC8_POLYNOMIAL, CRC8_START

COUNTS = 16
"""The rolling counter's modulus."""
SEQUENCES = 1 << 16
"""The modulus of the number that a request and its answer share."""
CHANNEL_LIMIT = 2.0 - 2.0**-16
"""Largest channel value [nominal amplitudes] that HallChannels can carry."""
SPEED_STEP_RPM = 0.5
FASTEST_RPM = 1023.5
"""What MotionCommand can carry."""
REFERENCE_CLOCK_S, HALL_CLOCK_S = 2.0**32 * 1e-5, 2.0**36 * 1e-7
"""After these times the clocks that ReferenceTime and HallTime tell begin anew."""

_CHECKSUM_BYTE = 7
_COUNTER_BYTE, _COUNTER_SHIFT = 6, 4


@dataclass(frozen=True)
class Frame:
    """A decoded frame. ``sound`` is whether its checksum is right; ``counter`` is None for what the bench sends."""

    name: str
    values: Mapping[str, float]
    counter: int | None
    sound: bool


@dataclass(frozen=True, eq=False)
class Messages:
    """The database's messages by name and by identifier."""

    by_name: Mapping[str, Any]
    by_identifier: Mapping[int, Any]

    def encode(self, name: str, values: Mapping[str, float], counter: int | None = None) -> can.Message:
        """A frame of physical values, with its checksum; ``counter`` (any whole number) for frames of nodes."""
        message = self.by_name[name]
        signals: dict[str, float] = {**values, "Checksum": 0}
        if counter is not None:
            signals["Counter"] = counter % COUNTS
        data = bytearray(message.encode(signals, strict=True))
        data[_CHECKSUM_BYTE] = checksum(message.frame_id, data)
        return can.Message(arbitration_id=message.frame_id, data=data, is_extended_id=False)

    def decode(self, message: can.Message) -> Frame | None:
        """The frame's content; None for one that is not of the bench."""
        declared = self.by_identifier.get(message.arbitration_id)
        foreign = message.is_extended_id or message.is_error_frame or message.is_remote_frame
        if declared is None or foreign or len(message.data) != declared.length:
            return None
        values: dict[str, Any] = declared.decode(bytes(message.data), decode_choices=False)
        sound = checksum(message.arbitration_id, message.data) == message.data[_CHECKSUM_BYTE]
        counter = values.get("Counter")
        return Frame(declared.name, values, None if counter is None else int(counter), sound)

    def name_of(self, message: can.Message) -> str | None:
        """The name of a frame's message, without decoding it."""
        declared = self.by_identifier.get(message.arbitration_id)
        return None if declared is None else str(declared.name)

    def sender(self, name: str) -> str:
        """The node that sends a message."""
        return str(self.by_name[name].senders[0])

    def sent_by(self, node: str) -> tuple[str, ...]:
        """The messages of a node."""
        return tuple(name for name in self.by_name if self.sender(name) == node)


@cache
def messages() -> Messages:
    """The packaged database."""
    import cantools

    text = resources.files(__package__).joinpath("halltwin.dbc").read_text(encoding="utf-8")
    database: Any = cantools.database.load_string(text, "dbc")
    return Messages(
        by_name={message.name: message for message in database.messages},
        by_identifier={message.frame_id: message for message in database.messages},
    )


def checksum(identifier: int, data: bytes | bytearray) -> int:
    """CRC-8/SAE-J1850 over the identifier (two bytes, low byte first) and the bytes before the checksum."""
    table = _crc_table()
    register = CRC8_START
    for byte in (identifier & 0xFF, identifier >> 8, *data[:_CHECKSUM_BYTE]):
        register = table[register ^ byte]
    return register ^ CRC8_FINAL


def with_counter(message: can.Message, counter: int) -> can.Message:
    """The same frame under another counter, with its checksum made right: what a stuck node would send."""
    held = message.data[_COUNTER_BYTE] >> _COUNTER_SHIFT
    return with_byte_flipped(message, _COUNTER_BYTE, (held ^ counter % COUNTS) << _COUNTER_SHIFT)


def with_byte_flipped(message: can.Message, place: int, bits: int) -> can.Message:
    """The same frame with these bits of a byte flipped, and its checksum made right."""
    data = bytearray(message.data)
    data[place] ^= bits
    data[_CHECKSUM_BYTE] = checksum(message.arbitration_id, data)
    return can.Message(arbitration_id=message.arbitration_id, data=data, is_extended_id=False)


@cache
def _crc_table() -> tuple[int, ...]:
    """The checksum's register after each byte value; twin.link.frames.crc8 is for arrays of frames, this for one."""
    table = []
    for register in range(256):
        for _ in range(8):
            register = (register << 1 ^ CRC8_POLYNOMIAL if register & 0x80 else register << 1) & 0xFF
        table.append(register)
    return tuple(table)
