"""Ground images, shade maps and sun forecasts from the imaging drone's frames.

`frames` keeps each vehicle's newest frame and has the imaging drone's projected on the ground;
`shade` has each ground image read for shade and sun. The heavy parts are jobs of the worker.
"""
