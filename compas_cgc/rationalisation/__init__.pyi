from .design import read_design as read_design
from .result import Rationalised as Rationalised
from .run import rationalise as rationalise
from .spline_surface import SplineSurface as SplineSurface
