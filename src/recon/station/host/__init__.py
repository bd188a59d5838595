"""The process of a station: its servers, files, guard and helpers' processes, started and stopped.

`run` is a live station, `replay_run` a recorded flight in the console, `new_site` the page for the
first site. Decisions are made in the rooms below; here is what outlives or serves them.
"""
