# The stubs that rhino3dm brings lack members that there are (Layer.Index, iteration over its tables) and call properties
# read-only that can be set (ObjectAttributes.LayerIndex), so that nothing can be checked against them.
from typing import Any

def __getattr__(name: str) -> Any: ...
