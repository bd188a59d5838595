"""The guard: a small process beside the station that can stop vehicles when the station cannot.

It holds a duplicate of every app's socket, so that it can write a hover on it without the station,
and after the station's death. The station tells it ten times a second what it believes of each
link; when that ends, the guard holds what the station steered. A person reaches it at its own port
(`docs/decisions/0012-a-guard-with-duplicates-of-the-sockets.md`).

`watch` decides and is pure, `process` has the sockets, `messages` is what both sides say.
"""
