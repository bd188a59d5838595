"""The station for hours: does its memory stay flat, does all stop stay fast, what does a kill lose?

__main__        options, and which of the three runs
hour            an hour in real time: who presses, samples and reports
world           the processes on one site: station, simulated apps, gateway
field           the site's folder and the faults of the links
clients         consoles, readers of tiles and MAVLink programs that come and go
surveyor        two surveys, flown again and again, also after each all stop
power_cut       each process killed, and what was lost, beside what docs/safety promises
virtual_days    days of battery changes in virtual time, with a step of the clock
figures         pure: windows, slopes, percentiles, tables, the verdict
"""
