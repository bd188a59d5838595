"""The kernel: the pure step over one queue of events, the drivers around it, and the worker.

`step` has the table of event handlers and the parts of a tick; `fault_isolation` is for steps that
raise. `driver` runs it all on real sockets and the real clock, `virtual` in virtual time; `worker`
runs heavy jobs. Records are in `station/recording`, a real station's process in `station/host`.
"""
