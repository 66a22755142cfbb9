from .pareto import pareto_figure as pareto_figure
from .pareto import pareto_front as pareto_front
from .results import Results as Results
from .run import run_study as run_study
from .sheet import contact_sheet as contact_sheet
from .spec import Study as Study
from .spec import read_study as read_study
