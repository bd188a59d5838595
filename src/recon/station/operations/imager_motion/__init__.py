"""What looks aside and moves upwind share: how a motion of an imaging drone begins, goes and ends.

`claim` gives guidance the imaging drone, `execution` follows its way and ends it, `notices` states
what an operator must know. Each kind decides what begins one and where it leads.
"""
