"""What is asked of a mesh, as JSON: checked before it is queued, assembled in the worker."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import fields
from typing import TYPE_CHECKING
from typing import Optional
from typing import Union

from ..discrete.arrays import FloatArray
from ..errors import MeshError
from .arrays import number
from .arrays import polygons
from .arrays import vertex_array
from .arrays import whole
from .limits import Limits
from .problems import Unprocessable

if TYPE_CHECKING:
    from ..datastructures import CGCMesh
    from ..methods import Settings

__all__ = ["OPTIONS", "Asked", "check_request", "read_asked", "read_request"]

OPTIONS = ("supports", "creases", "targets", "method", "settings", "flip", "live", "name", "id")
MESH_TYPE, CGC_MESH = "compas.datastructures/Mesh", "compas_cgc.datastructures/CGCMesh"
MESH = ("vertices", "faces", "roles", "mesh")


@dataclass(frozen=True)
class Asked:
    """What is asked, apart from the mesh; None where nothing is said.

    Parameters
    ----------
    supports
        Vertices, ``"boundary"`` or ``"corners"``.
    creases
        Paths of vertices.
    targets
        A number, a number or None per vertex, or a number per region (by its number) [1/L^2].
    method
        A method of :func:`compas_cgc.solve`.
    settings
        Its settings by name.
    flip
        Whether to turn the mesh over.
    live
        Whether the moving surface is reported.
    """

    supports: Union[str, list[int], None] = None
    creases: Optional[list[list[int]]] = None
    targets: Union[float, list[Optional[float]], dict[int, float], None] = None
    method: str = "auto"
    settings: Optional[dict] = None
    flip: bool = False
    live: bool = False

    def put_on(self, mesh: CGCMesh) -> CGCMesh:
        """Return the mesh, a new one of the caller's, with all this asked of it.

        Raises
        ------
        ValueError
            If a crease does not follow edges, or there is no such vertex or region.
        """
        if self.flip:
            mesh.flip()
        if self.creases is not None:
            mesh.set_creases(self.creases)
        if self.supports is not None:
            mesh.set_supports(self.supports)
        if isinstance(self.targets, dict):
            for region, K in self.targets.items():
                mesh.set_target(K, region=region)
        elif isinstance(self.targets, list):
            for key, K in zip(mesh.vertices(), self.targets):
                if K is not None:
                    mesh.vertex_target(key, K)
        elif self.targets is not None:
            mesh.set_target(self.targets)
        return mesh

    def method_settings(self) -> Optional[Settings]:
        """Return the settings of the method, None where nothing is said."""
        return _settings(self.method, self.settings or {})


def check_request(value: object, limits: Limits) -> None:
    """Check a request without building the mesh, which is the worker's part.

    Raises
    ------
    Unprocessable, TooLarge
        With a sentence that names the field.
    """
    _check_fields(value)
    if value.get("mesh") is None:
        vertices, _ = _arrays(value, limits)
        read_asked(value, len(vertices), limits)
    else:
        read_asked(value, None, limits)
        _check_compas_mesh(value["mesh"], limits)


def read_request(value: object, limits: Limits) -> tuple[CGCMesh, Asked]:
    """Return the mesh and what is asked of it.

    Raises
    ------
    Unprocessable, TooLarge
        With a sentence that names the field.
    """
    from ..datastructures import CGCMesh

    _check_fields(value)
    if value.get("mesh") is not None:
        return _compas_mesh(value["mesh"], limits), read_asked(value, None, limits)
    vertices, faces = _arrays(value, limits)
    asked = read_asked(value, len(vertices), limits)
    try:
        return CGCMesh.from_vertices_and_faces(vertices, faces), asked
    except MeshError as error:
        raise Unprocessable(str(error)) from None


def _check_fields(value: object) -> None:
    if not isinstance(value, dict):
        raise Unprocessable("the request must be a JSON object with 'vertices' and 'faces', or 'mesh'")
    unknown = sorted(set(value) - set(OPTIONS) - set(MESH))
    if unknown:
        raise Unprocessable(f"there is no field {unknown[0]!r:.60}; there are {', '.join(MESH + OPTIONS)}")


def _arrays(value: dict, limits: Limits) -> tuple[FloatArray, Sequence[Sequence[int]]]:
    vertices = vertex_array(value.get("vertices"), limits)
    return vertices, polygons(value.get("faces"), len(vertices), limits)


def read_asked(value: dict, count: Optional[int], limits: Limits) -> Asked:
    """Return what is asked of a mesh of `count` vertices (None: not known yet)."""
    from ..methods import METHODS

    method = value.get("method", "auto")
    if method not in ("auto", *METHODS):
        raise Unprocessable(f"'method' must be one of auto, {', '.join(METHODS)}")
    supports = value.get("supports")
    roles = value.get("roles")
    if roles is not None:
        supports = _supports_of_roles(roles, count, value)
    elif isinstance(supports, str):
        if supports not in ("boundary", "corners"):
            raise Unprocessable('\'supports\' must be a list of vertices, "boundary" or "corners"')
    elif supports is not None:
        supports = _indices(supports, count, "'supports'")
    creases = value.get("creases")
    if creases is not None:
        if not isinstance(creases, list):
            raise Unprocessable("'creases' must be a list of paths, each a list of vertices along edges")
        creases = [_indices(path, count, f"crease {i}") for i, path in enumerate(creases)]
    for name in ("flip", "live"):
        if not isinstance(value.get(name, False), bool):
            raise Unprocessable(f"'{name}' must be true or false")
    asked = Asked(
        supports,
        creases,
        _targets(value.get("targets"), count),
        method,
        _checked_settings(method, value.get("settings"), limits),
        value.get("flip", False),
        value.get("live", False),
    )
    return asked


def _supports_of_roles(roles: object, count: Optional[int], value: dict) -> list[int]:
    if value.get("supports") is not None:
        raise Unprocessable("give 'roles' or 'supports', not both")
    if not isinstance(roles, list) or (count is not None and len(roles) != count):
        raise Unprocessable(f"'roles' must be a list of one role per vertex ({count})")
    wrong = next((i for i, role in enumerate(roles) if role not in ("internal", "fixed", "crease", "free")), None)
    if wrong is not None:
        raise Unprocessable(f"the role of vertex {wrong} must be internal, fixed, crease or free")
    if "crease" in roles and not value.get("creases"):
        raise Unprocessable("'roles' has crease vertices; say which edges fold as 'creases', paths of vertices")
    return [i for i, role in enumerate(roles) if role == "fixed"]


def _indices(value: object, count: Optional[int], what: str) -> list[int]:
    if not isinstance(value, list):
        raise Unprocessable(f"{what} must be a list of vertices")
    indices = [whole(v, f"every vertex of {what}") for v in value]
    wrong = [v for v in indices if v < 0 or (count is not None and v >= count)]
    if wrong:
        raise Unprocessable(f"{what} names vertex {wrong[0]}, which does not exist")
    return indices


def _targets(value: object, count: Optional[int]) -> object:
    if value is None:
        return None
    if isinstance(value, list):
        if count is not None and len(value) != count:
            raise Unprocessable(f"'targets' has {len(value)} numbers for {count} vertices; give one each, or one number for all")
        return [None if K is None else number(K, f"the target of vertex {i}") for i, K in enumerate(value)]
    if isinstance(value, dict):
        if not all(key.isdecimal() and len(key) < 7 for key in value):
            raise Unprocessable('\'targets\' by region must be named by the numbers of the regions, such as {"0": 0.01, "1": 0.04}')
        return {int(key): number(K, f"the target of region {key}") for key, K in value.items()}
    return number(value, "'targets'")


def _checked_settings(method: str, value: object, limits: Limits) -> dict:
    value = {} if value is None else value
    if not isinstance(value, dict):
        raise Unprocessable("'settings' must be an object of settings by name")
    for name, entry in value.items():
        if isinstance(entry, (int, float)) and not isinstance(entry, bool):
            number(entry, f"the setting {name:.40}")
        elif not (entry is None or isinstance(entry, (bool, str))):
            raise Unprocessable(f"the setting {name:.40} must be a number, a text, true or false")
    value = {name: whole(entry, f"the setting {name}") if name in ("steps", "q", "e") else entry for name, entry in value.items()}
    settings = _settings(method, value)
    if settings is not None and settings.steps > limits.steps:
        raise Unprocessable(f"the setting steps is {settings.steps}, the server takes at most {limits.steps} steps")
    return value


def _settings(method: str, value: dict) -> Optional[Settings]:
    """Return the settings of a method; with ``auto`` those of the only method that has all of them."""
    from ..methods import SETTINGS

    if not value:
        return None
    names = {kind: [field.name for field in fields(SETTINGS[kind])] for kind in (SETTINGS if method == "auto" else [method])}
    unknown = sorted(name for name in value if not any(name in known for known in names.values()))
    if unknown:
        known = ", ".join(dict.fromkeys(name for own in names.values() for name in own))
        raise Unprocessable(f"there is no setting {unknown[0]!r:.60}; there are {known}")
    kinds = [kind for kind, own in names.items() if set(value) <= set(own)]
    if len(kinds) != 1:
        raise Unprocessable(f"the settings {', '.join(sorted(value))} do not belong to one method; name it with 'method'")
    try:
        return SETTINGS[kinds[0]](**value)
    except (TypeError, ValueError) as error:
        raise Unprocessable(f"settings: {error}") from None


def _compas_mesh(value: object, limits: Limits) -> CGCMesh:
    """Return the mesh of COMPAS JSON; nothing but a Mesh or CGCMesh is decoded."""
    from compas.datastructures import Mesh

    from ..datastructures import CGCMesh

    _check_compas_mesh(value, limits)
    try:
        mesh = (CGCMesh if value["dtype"] == CGC_MESH else Mesh).__from_data__(value["data"])
        return mesh if isinstance(mesh, CGCMesh) else CGCMesh.from_mesh(mesh)
    except Exception:
        raise Unprocessable("'mesh' cannot be read as a COMPAS mesh; write it with compas.json_dumps") from None


def _check_compas_mesh(value: object, limits: Limits) -> None:
    if not isinstance(value, dict) or value.get("dtype") not in (MESH_TYPE, CGC_MESH) or not isinstance(value.get("data"), dict):
        raise Unprocessable("'mesh' must be a COMPAS Mesh as JSON (compas.json_dumps), with 'dtype' and 'data'")
    data = value["data"]
    if _mentions_dtype(data):
        raise Unprocessable("'mesh' must hold plain numbers and texts only, no further COMPAS objects")
    if not isinstance(data.get("vertex"), dict) or not isinstance(data.get("face"), dict):
        raise Unprocessable("'mesh' must hold 'vertex' and 'face'")
    order = {str(key): i for i, key in enumerate(data["vertex"])}
    try:
        vertices = [[entry["x"], entry["y"], entry["z"]] for entry in data["vertex"].values()]
        corners = [[order[str(v)] for v in face] for face in data["face"].values()]
    except (KeyError, TypeError):
        raise Unprocessable("'mesh' must hold x, y and z of every vertex, and faces of existing vertices") from None
    polygons(corners, len(vertex_array(vertices, limits)), limits)


def _mentions_dtype(value: object) -> bool:
    if isinstance(value, dict):
        return "dtype" in value or any(_mentions_dtype(item) for item in value.values())
    return isinstance(value, list) and any(_mentions_dtype(item) for item in value if isinstance(item, (dict, list)))
