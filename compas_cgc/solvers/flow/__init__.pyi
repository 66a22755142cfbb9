from .curve import CurveResult as CurveResult
from .curve import curve_flow as curve_flow
from .gradient_flow import flow as flow
from .method import METHOD as METHOD
from .settings import FlowSettings as FlowSettings
