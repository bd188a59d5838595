"""Base maps: raster tiles of a site from files, what of it they cover, and tiles from a server.

Files come from anywhere, so they are read in a process of their own (`map_process`).
"""
