"""The line from ground images to shade maps and forecasts, run live.

`line` is what the station knows of it, `work` what the worker does, `reading` the steps between,
`told` what is shown and alarmed.
"""
