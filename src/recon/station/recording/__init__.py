"""Records of the station's steps: taken while it runs, read again as a replay.

`recording` hands steps and keyframes to the process that writes; `replay` steps recorded events
again and compares, `playback` moves through a record for the console.
"""
