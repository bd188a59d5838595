"""What becomes of numbers on the wire: the aircraft flies what was sent, not what was meant."""

import struct
from math import copysign, inf


def as_sent(value: float) -> float:
    """Return the number that the wire's 32-bit float makes of it: what is tiny becomes 0.

    What no such float can hold becomes infinite. Of a greater number it is never less.
    """
    try:
        return float(struct.unpack(">f", struct.pack(">f", value))[0])
    except OverflowError:
        return copysign(inf, value)
