"""One companion app as the station sees it: telemetry and video out, commands in, faults injected.

It has neither socket nor clock: a driver (`recon.sim.run`, or a test) moves the bytes and the time.
Its aircraft is in `recon.sim.flight`; its pictures come from `recon.sim.camera`.
"""
