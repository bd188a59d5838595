"""Who is there: links, identity by serial, telemetry folded into vehicle states, staleness.

`step(fleet, event, now_ns) -> (fleet, outputs)` is pure.
"""
