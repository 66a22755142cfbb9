from ._samples import get as get
from ._samples import samples as samples
from ._version import __version__ as __version__
from .analysis import analyse as analyse
from .datastructures import CGCMesh as CGCMesh
from .datastructures import SolveResult as SolveResult
from .errors import CGCError as CGCError
from .errors import FileError as FileError
from .errors import MeshError as MeshError
from .errors import ProblemError as ProblemError
from .io import read as read
from .io import write as write
from .model.checks import check as check
from .model.constraints import Constraint as Constraint
from .model.constraints import Fixed as Fixed
from .model.constraints import Height as Height
from .model.constraints import Mirror as Mirror
from .model.constraints import OnCurve as OnCurve
from .model.constraints import OnLine as OnLine
from .model.constraints import OnPlane as OnPlane
from .model.constraints import Proximity as Proximity
from .model.goals.inequalities import Above as Above
from .model.goals.inequalities import Below as Below
from .model.goals.inequalities import Clearance as Clearance
from .model.goals.inequalities import NearPlane as NearPlane
from .model.goals.inequalities import Within as Within
from .model.goals.places import EdgeInPlan as EdgeInPlan
from .model.goals.places import Level as Level
from .model.goals.places import OnSurface as OnSurface
from .model.goals.wholes import Area as Area
from .model.goals.wholes import Length as Length
from .model.goals.wholes import Rise as Rise
from .model.goals.wholes import Unknown as Unknown
from .model.goals.wholes import Volume as Volume
from .model.laws import ConstantCurvature as ConstantCurvature
from .model.laws import ConstantMeanCurvature as ConstantMeanCurvature
from .model.laws import Law as Law
from .model.laws import LinearWeingarten as LinearWeingarten
from .model.laws import Minimal as Minimal
from .model.problem import CGCProblem as CGCProblem
from .rationalisation.run import rationalise as rationalise
from .solvers.flow import FlowSettings as FlowSettings
from .solvers.newton import NewtonSettings as NewtonSettings
from .solvers.projection import ProjectionSettings as ProjectionSettings
from .solvers.registry import settings_for as settings_for
from .solvers.run import solve as solve
from .solvers.sensitivity import sensitivity as sensitivity
from .solvers.settings import AutoSettings as AutoSettings

__author__: str
__copyright__: str
__license__: str
HERE: str
HOME: str
DATA: str
