"""Plans that other programs fly: a flight as a neutral value in, the bytes of a file out.

`from_survey` makes the flights, `formats` chooses a writer by a file's suffix, `features` says what
each format can hold. Everything is pure.
"""
