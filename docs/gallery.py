"""Gallery of the manual; run this file to draw the pictures and to write gallery.md."""

from __future__ import annotations

import inspect
import json
import re
import sys
from collections.abc import Callable
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any
from typing import NamedTuple

import drawings
import numpy as np

from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import Level
from compas_cgc import Rise
from compas_cgc import solve
from compas_cgc._atomic_write import write_text
from compas_cgc.plot import View
from compas_cgc.plot import key_of
from compas_cgc.plot import save
from compas_cgc.plot import studio

DOCS = Path(__file__).parent


class Picture(NamedTuple):
    """A drawing with the view, the options of the solve, and the colouring of its picture."""

    drawing: Callable[[], CGCMesh]
    view: View
    options: Mapping[str, Any] = {}
    by_curvature: bool = False


PICTURES = {
    "nine_regions": Picture(drawings.nine_regions, View(-62.0, 24.0, 2.4)),
    "vault": Picture(drawings.vault, View(-58.0, 20.0, 2.6)),
    "canopy": Picture(drawings.canopy, View(-72.0, 20.0, 2.6)),
    "facade": Picture(drawings.facade, View(-118.0, 14.0, 2.6)),
    "cushion": Picture(drawings.cushion, View(-60.0, 24.0, 2.6), {"goals": [Rise(0.8)], "unknown": "all"}),
    "oculus": Picture(drawings.oculus, View(-60.0, 30.0, 2.6), {"goals": [Level()]}),
    "strips": Picture(drawings.strips, View(-52.0, 26.0, 2.4), by_curvature=True),
    "soap_film": Picture(drawings.soap_film, View(-66.0, 22.0, 2.6)),
    "air_cushions": Picture(drawings.air_cushions, View(-58.0, 26.0, 2.6)),
    "inner_layer": Picture(drawings.inner_layer, View(-62.0, 20.0, 2.6)),
}


def drawn(problem: CGCProblem, picture: Picture, width: int = 1200) -> object:
    """Return the picture of a surface, coloured by region or by target curvature."""
    K = np.where(problem.asked, problem.targets, np.nan) if picture.by_curvature else None
    shape = problem.vertices, problem.faces, problem.roles, problem.creases
    return studio(*shape, curvature=K, view=picture.view, width=width, key=key_of(problem))


PAGE = """# Gallery

The code below each picture computes the surface, and `compas_cgc.plot.studio` draws it. All surfaces have the verdict **fair**, and the
error of their curvature is at rounding level. `python docs/gallery.py` creates this page.

```python
import numpy as np
from compas_cgc import CGCMesh, Level, Rise, solve
```

"""


def page() -> str:
    """Return the text of the gallery."""
    text = PAGE
    for name, picture in PICTURES.items():
        lines = re.sub(r": (int|float) = ", "=", inspect.getsource(picture.drawing).replace(" -> CGCMesh", "")).splitlines()
        title = (picture.drawing.__doc__ or "").rstrip(".")
        body = [lines[0], *lines[2:], "", "", f"result = solve({', '.join([f'{name}()', *map(_written, picture.options.items())])})"]
        text += f"## {name.replace('_', ' ').capitalize()}\n\n{title}.\n\n![{title}](images/gallery/{name}.png)\n\n"
        text += '??? example "The code"\n\n    ```python\n' + "".join(f"    {line}\n" if line else "\n" for line in body)
        text += "    ```\n\n"
    return text.rstrip() + "\n"


def _written(option: tuple[str, Any]) -> str:
    """Return an option as one writes it: of a goal, what is not its default."""
    name, value = option
    goals = value if isinstance(value, list) else []
    given = [[getattr(goal, own.name) for own in fields(goal) if getattr(goal, own.name) != own.default] for goal in goals]
    shown = [f"{type(goal).__name__}({', '.join(map(repr, own))})" for goal, own in zip(goals, given)]
    return f"{name}=[{', '.join(shown)}]" if goals else f"{name}={json.dumps(value)}"


if __name__ == "__main__":
    for name in sys.argv[1:] or PICTURES:
        found = solve(PICTURES[name].drawing(), **PICTURES[name].options)
        print(name, found.message, found.verdict, flush=True)
        save(drawn(found.problem, PICTURES[name]), DOCS / "images" / "gallery" / f"{name}.png")
    write_text(DOCS / "gallery.md", page())
