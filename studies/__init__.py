"""Long runs that show what a test's few seconds cannot.

`make study` runs those that check something; some have a short run in `tests/studies`.
"""
