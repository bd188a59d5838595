"""A scenario flown by the whole station in virtual time: every byte, the gate, the watchdogs.

`apps` joins simulated apps to the virtual driver, `scripted_operator` acts for the people at a
field, `imager` stands between frames and the station where the truth is to be seen, `sight` scores
what the station saw, `ways` what truly happened; `run` puts them together.
"""

from recon.score.whole.run import run_whole

__all__ = ["run_whole"]
