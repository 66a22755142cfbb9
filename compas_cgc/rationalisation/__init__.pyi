from .design import read_design as read_design
from .mould_sweep import Sweep as Sweep
from .mould_sweep import sweep as sweep
from .picture import panels_figure as panels_figure
from .result import Rationalised as Rationalised
from .run import rationalise as rationalise
from .scene_objects import add_to_scene as add_to_scene
from .spline_surface import SplineSurface as SplineSurface
