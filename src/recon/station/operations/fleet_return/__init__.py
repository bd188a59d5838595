"""The fleet return: vehicles called home in layers, one landing mission each, in waves.

`record` holds what is known of it, `call` begins it, `advance` carries it on with every tick, and
`told` says it to consoles. It lives in memory only: a station started anew resumes nothing.
"""
