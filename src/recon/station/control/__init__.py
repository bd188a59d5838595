"""Orders to vehicles, from the gate to their end, and the authority over each vehicle.

`order_gateway` takes every order, asks the gate and updates open orders at each packet and tick.
`mode_tracking` compares telemetry with each vehicle's intent and finds
the ends of orders, pilot takeovers and failsafes.
"""
