"""Every identified vehicle of a station as a MAVLink 2 vehicle of its own.

    station's states --> step --> messages --> clients (UDP, TCP)
    station's answers --^    \\--> orders --> station
    clients' messages --^

`step(state, input, now_ns) -> (state, outputs)` is pure: no socket, clock or request inside.
`run.py` is the shell around it.

What is shown is telemetry, and each sample once: a vehicle without live telemetry sends nothing, no
heartbeat either, and clients call it lost. Orders pass the station's gate as the person whose login
the gateway has; the gateway decides nothing about them.
"""
