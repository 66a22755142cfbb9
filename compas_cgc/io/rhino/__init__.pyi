from ..summary import describe as describe
from .layers import LayerNames as LayerNames
from .layers import layer_names as layer_names
from .mould_layers import write_moulds as write_moulds
from .read import read_3dm as read_3dm
from .result_layers import write_result as write_result
from .write import write_problem as write_problem
