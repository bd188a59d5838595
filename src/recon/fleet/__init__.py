"""Links, vehicle identity by serial, telemetry per vehicle, staleness, order confirmation.

`step(fleet, event, now_ns) -> (fleet, outputs)` is pure.
"""
