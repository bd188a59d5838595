"""Random closed-loop runs of the whole station in virtual time, each from one seed.

Every run draws a site, a fleet, links, faults, pilots and people who give orders. The station runs
with all bytes between it and the simulated apps; oracles of their own (`tests/oracles/flown_air`,
`flown_orders`) watch the simulator's truth at every step of 0.1 s.

A violation is an episode: it begins when the truth breaks a limit, and ends 3 s after it was last
broken. It is classed at its beginning, by the first rule that holds. The marks of a vehicle are
taken from the truth, from the bytes that passed, and from nothing that the station concludes
(`marks.py`):

pilot
    A pilot flew a vehicle of it within the last 12 s, or had left it where it now is, and it has
    not been moved by an order since.
fault
    For a vehicle of it, within the last 12 s and in flight: no telemetry reached the station for
    1 s; no downlink lived, or its app or aircraft ignored what it received (fault, no GNSS, reading
    slowly, landing automatically on an empty battery); or its heights were wrong by a fault. A
    shown place that was never sent is a fault when bytes of the vehicle were changed on their way
    within that time: the protocol has no checksum, and decimetres are no jump.
physics
    The station has had telemetry of a vehicle of it for less than 8 s (or was started less than 8 s
    ago): what both need to stop from 15 m/s, one after the other. Or, within the last 8 s, wind
    pushed a vehicle of it by more than 1 m/s off what it was commanded to fly. A takeoff counts
    when the aircraft had landed less than 1 s before it.
person
    A person's order that is always sent took the vehicle there (land, return: never judged by
    places; nor held by a watchdog while a person has given the vehicle to its pilot), an operator
    had switched the separation holds off, or left a vehicle in the air for 20 s under a battery
    alarm.
station
    Everything else.

A hold that arrived late is a fault when within the last second the vehicle was without telemetry at
the station for 1 s, or without a living downlink, or obeyed nothing; else the station's.

What this excludes: the simulator's ground is the plane of a vehicle's first takeoff, so on a
slope heights of a vehicle that came down elsewhere count as wrong (fault) from then on.
"""
