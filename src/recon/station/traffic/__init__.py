"""What may be in the air, and what the watchdogs find there.

`known_traffic` lists every vehicle that flies or may, connected or lost, identified or not;
`identity_grace` excludes links that are most likely a known vehicle reconnecting;
`watchdog_runner` runs the watchdogs ten times a second, and returns the holds they require.
"""
