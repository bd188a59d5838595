"""The messages of MAVLink's common set, as pymavlink makes them.

pymavlink is LGPL-3.0: it is imported as a package of its own, and nothing of it is copied.
"""

from pymavlink.dialects.v20 import common as mavlink

COMPONENT = mavlink.MAV_COMP_ID_AUTOPILOT1
"""Clients take a heartbeat of this component alone for a vehicle's."""

ENCODED_DEGREE = 1e7
UNKNOWN_INT32 = 2**31 - 1
UNKNOWN_UINT16 = 2**16 - 1
"""What the protocol writes for an unknown value."""
