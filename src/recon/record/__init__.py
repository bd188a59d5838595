"""Files that outlive the process; what is written, and when, is decided by the station.

`mcap` has flight records, `audit` the log of every order, `raster` maps and images as GeoTIFF,
`files` everything that is replaced as a whole: snapshot, users, a site's layers with undo.
"""
