"""Setpoint streams: a goto, nudge or hold position flown by virtual sticks at 10 Hz.

`setpoint_streams` computes each setpoint and has it judged; `stream_ends` ends a stream safely.
`neutral_setpoint` ends single sticks; `control` calls this room and applies what it returns.
"""
