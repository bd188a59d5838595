"""Fields, zones and points in files of other programs, read whatever they are wanted for.

`field_file` is the door. A file is unpacked, and read in a process with limits of its own, which
imports from here alone: this package loads nothing.
"""
