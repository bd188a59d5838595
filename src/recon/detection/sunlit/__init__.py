"""Parts of the method `sunlit_reference`: see docs/detection-and-forecast.md.

Light is the natural log of linear light in green, colour the natural log of blue over red: in shade
a cell is darker and bluer. Both are (R, C) float32 on the field grid or a coarser one, NaN where
not seen.
"""
