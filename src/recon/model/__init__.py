"""The words all rooms share: frozen values with units and frames in their names.

Times are int64 nanoseconds of station time (monotonic within one run). Ground coordinates are
east-north-up metres of the site's local frame. This package imports nothing else of Recon.
"""
