"""Moulds: the panels of all regions on as few surfaces of constant curvature as possible."""

from __future__ import annotations

import math
from collections.abc import Callable
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np
from scipy.optimize import minimize_scalar

from ..discrete import face_areas
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask
from ..discrete.arrays import Vertices
from ..discrete.local_fits import LocalFits
from ..discrete.local_fits import local_fits
from ..discrete.space_form import space_form_angle_sums
from ..errors import CGCError
from ..errors import names_what_was_meant
from ..meshing import boundary_loops
from ..model.given import checked_number
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from . import space_form
from .bending import corner_operators
from .bending import curvature_changes
from .bending import fitted_operators
from .bending import plate_stress
from .bending import unbounded_curvature
from .caps import smallest_cap
from .development import Development
from .development import check_disk
from .development import lay_out
from .figures import unit_symbol
from .fitting import rigid_fits
from .materials import Material
from .materials import material_named
from .materials import metres_per_unit
from .materials import refuse_foil
from .mould_report import Mould
from .mould_report import MouldReport
from .mould_report import PanelFit
from .mould_surface import MouldSurface
from .mould_surface import surface_for
from .panel_parts import PanelParts
from .panel_parts import PartsOnMould
from .panel_parts import on_mould
from .panel_parts import parts_of
from .panel_seams import panel_seams
from .panelling import Panel
from .revolved_mould import RevolvedMould
from .revolved_mould import closest_sizes
from .revolved_mould import size_range
from .shape_operators import principal_curvatures
from .solved import solved_problem

__all__ = ["moulds"]

K_TOLERANCE = 1e-9  # relative difference below which two curvatures count as equal
MAX_GAP = 0.05  # gap relative to the mean edge length above which the surface does not have the K of the mould
ROTATIONS = 24  # rotations about the pole compared on a pseudosphere, before the best is refined
SIZE_TOLERANCE = 1e-3  # of the logarithm of the radius of a mould of least bending
ANGLE_TOLERANCE = 2e-3  # of the rotation of least bending [rad]


class _Laid(NamedTuple):
    panel: Panel
    K: float
    parts: PanelParts  # flipped if the panel is concave towards its normals
    laid: Development  # of the whole mesh faces
    there: PartsOnMould
    radius: float
    places: FloatArray  # (m, 3, 3) corners of the whole mesh faces in position [L]


def _instead(name: str) -> str:
    """Return what to write instead of an argument that `moulds` does not take."""
    return f"give it to the panels: moulds(surface, panels(surface, {name}=...))" if name in ("size", "count", "curves", "along") else ""


@names_what_was_meant(_instead)
def moulds(
    mesh: PosesProblem,
    panels: Sequence[Panel],
    *,
    material: Union[str, Material] = "glass",
    thickness: float = 6.0,
    tolerance: float = 0.0,
    arc: Optional[bool] = None,
    least_bending: bool = False,
    rough: bool = False,
) -> MouldReport:
    """Return the moulds on which panels can be made, and the fit of each panel.

    By Minding's theorem every piece of a region of curvature K can be bent without stretching from the sphere of radius ``1/√K``,
    the plane or the pseudosphere; after a solve with ``measure="exact"`` the triangles are congruent to rounding. So one mould
    serves all panels of one K in any region.

    Parameters
    ----------
    mesh
        Solved surface.
    panels
        Result of :func:`compas_cgc.fabrication.panels`, or other groups of faces.
    material
        A name of :data:`~compas_cgc.fabrication.MATERIALS`, or a :class:`~compas_cgc.fabrication.Material`.
    thickness
        Thickness of the sheets [mm].
    tolerance
        Largest gap with which panels of different K may share a mould [mm].
    arc
        Whether edges are arc lengths on the moulds. Default: whichever fits better.
    least_bending
        Whether to choose the mould of every K among more surfaces of revolution, so that bending is least: spindles and bulges besides
        the sphere, and hyperboloids besides the pseudosphere. Default: sphere, plane and pseudosphere.
    rough
        Whether to accept a surface with the verdict rough.

    Returns
    -------
    MouldReport
        ``str(report)`` is a readable text; ``to_dict`` returns all figures.

    Raises
    ------
    CGCError
        If the surface is rough or does not have its target curvature, or a panel has several K, a hole, or is too large for a mould.

    References
    ----------
    Jiang et al., *Using isometries for computational design and fabrication*, doi:10.1145/3450626.3459839. Bending stress of a plate:
    ``E t Δκ / 2 (1 - ν²)``.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import panels
    >>> result = compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm")))
    >>> len(moulds(result, panels(result, 3.0), material="timber").panels)
    6
    """
    problem = solved_problem(mesh, rough)
    stuff, unit = material_named(material), metres_per_unit(problem.drawing.units)
    if not 0.0 < checked_number(thickness, "thickness") < math.inf:
        raise CGCError(f"the thickness must be a positive number [mm], not {thickness!r}")
    refuse_foil(thickness)
    if not (math.isfinite(tolerance) and tolerance >= 0.0):
        raise CGCError(f"the tolerance must be at least 0 mm, not {tolerance!r}")
    _check_panels(problem, panels)
    targets = problem.region_targets()
    curvatures = [_curvature_of(problem, panel, targets) for panel in panels]
    fits = local_fits(problem.vertices, problem.faces, problem.asked, problem.asked)
    operators, unbounded = corner_operators(problem), unbounded_curvature(problem)
    fitted = fitted_operators(problem, operators)
    by_arcs = _by_arcs(problem) if arc is None else arc
    pieces = [_laid(problem, panel, K, fits, by_arcs) for panel, K in zip(panels, curvatures)]
    pieces = _shared(problem, pieces, 1e-3 * tolerance / unit, by_arcs)
    groups: dict[float, list[_Laid]] = {}
    for piece in pieces:
        groups.setdefault(piece.laid.K, []).append(piece)
    made: list[Mould] = []
    results: dict[str, PanelFit] = {}
    for K in sorted(groups, reverse=True):
        radius = max(piece.radius for piece in groups[K])
        surface = _least_bending(groups[K], radius, operators) if least_bending else surface_for(K, radius)
        made.append(Mould(len(made) + 1, surface, radius, len(groups[K])))
        for piece in groups[K]:
            results[piece.panel.name] = _fitted(piece, made[-1], (operators, fitted), unbounded, stuff, thickness, unit)
    return MouldReport(
        made, [results[panel.name] for panel in panels], stuff, float(thickness), unit, by_arcs, panel_seams(problem, panels)
    )


def _check_panels(problem: CGCProblem, panels: Sequence[Panel]) -> None:
    """Refuse invalid panels and duplicate names."""
    given: object = panels
    if isinstance(given, str) or not isinstance(given, Sequence):
        raise CGCError(f"panels must be the result of panels(surface, size), not {panels!r:.60}")
    if not len(panels):
        raise CGCError("there are no panels; divide the surface into panels first")
    called: set[str] = set()
    for panel in panels:
        if panel.name in called:
            raise CGCError(f"two panels have the name {panel.name}; give each a different name")
        called.add(panel.name)
        own = np.asarray(panel.faces)
        among = len(problem.faces if panel.cut is None else panel.cut.faces)
        if not own.size or own.dtype.kind not in "iu" or own.min() < 0 or own.max() >= among:
            raise CGCError(f"the faces of panel {panel.name} must be indices from 0 to {among - 1} of the mesh")
        if panel.cut is not None and not np.array_equal(panel.cut.vertices[: len(problem.vertices)], problem.vertices):
            raise CGCError(f"panel {panel.name} belongs to another surface; divide this surface into panels")


def _curvature_of(problem: CGCProblem, panel: Panel, targets: list[Optional[float]]) -> float:
    """Return the single target K of a panel."""
    used = np.unique(problem.faces[panel.faces if panel.cut is None else np.unique(panel.cut.parent[panel.faces])])
    asked = used[problem.asked[used] & np.isfinite(problem.targets[used])]
    own = np.unique(problem.targets[asked])
    if not len(own):
        target = targets[panel.region] if 0 <= panel.region < len(targets) else None
        if target is None:
            raise CGCError(f"panel {panel.name} has no target K̄; set one for its region")
        return target
    low, high = float(own[0]), float(own[-1])
    if low < 0.0 < high:
        raise CGCError(
            f"panel {panel.name} has targets K̄ from {low:.4g} to {high:.4g}, "
            "but all K on a mould have the same sign; divide the panel where the sign of K changes"
        )
    if high - low > K_TOLERANCE * max(abs(low), abs(high)):
        raise CGCError(
            f"panel {panel.name} has targets K̄ from {low:.4g} to {high:.4g}, but a mould has a single K; set a single K̄ per panel"
        )
    return high


def _by_arcs(problem: CGCProblem) -> bool:
    """Check whether the triangles close better as arcs of the moulds than as chords."""
    asked = problem.asked & np.isfinite(problem.targets)
    K = np.where(asked, problem.targets, 0.0)
    chords, arcs = (
        np.abs(space_form_angle_sums(problem.vertices, problem.faces, K, arc) - 2 * np.pi)[asked].sum() for arc in (False, True)
    )
    return bool(arcs < 0.1 * chords)


def _laid(problem: CGCProblem, panel: Panel, K: float, fits: LocalFits, arc: bool) -> _Laid:
    """Lay a panel onto its mould, flipped if it is concave towards its normals."""
    parts = parts_of(problem, panel)
    mean = fits.mean[np.unique(parts.whole)]
    hollow = K > 0.0 and np.isfinite(mean).any() and float(np.nansum(mean)) < 0.0
    return _on(problem, panel, K, parts_of(problem, panel, turned=True) if hollow else parts, arc)


def _on(problem: CGCProblem, panel: Panel, K: float, parts: PanelParts, arc: bool) -> _Laid:
    name = f"panel {panel.name}"
    check_disk(parts.faces, name)
    # The whole faces may enclose a notch of the panel.
    seam = "auto" if parts.cut and len(boundary_loops(parts.whole)) != 1 else None
    laid = lay_out(problem.vertices, parts.whole, K, seam, arc=arc, name=name)
    laid = laid._replace(own_faces=parts.own_faces)
    there = on_mould(parts, laid, arc)
    V = problem.vertices[parts.whole]
    edge = float(np.linalg.norm(np.roll(V, -1, axis=1) - V, axis=2).mean())
    if there.gap > MAX_GAP * edge:
        raise CGCError(
            f"panel {panel.name} does not close on a mould of K = {K:.4g}: gaps of {there.gap:.3g} {unit_symbol(problem.drawing.units)}; "
            "solve the surface for this K first, best with the measure exact"
        )
    cap = smallest_cap(there.on_form, K)
    laid = laid.turned(space_form.to_pole(cap.centre, K))
    return _Laid(panel, K, parts, laid, on_mould(parts, laid, arc), cap.radius, V)


def _shared(problem: CGCProblem, pieces: list[_Laid], tolerance: float, arc: bool) -> list[_Laid]:
    """Let panels of similar K share a mould if gaps and edge errors stay within a tolerance [L]."""
    own = sorted({piece.K for piece in pieces})
    groups: list[list[float]] = [[own[0]]]
    laid: dict[float, list[_Laid]] = {}
    for K in own[1:]:
        group = [*groups[-1], K]
        middle = 0.5 * (group[0] + K)
        same = K - group[0] <= K_TOLERANCE * abs(K)
        # A shared K must not change sign: a spherical sheet cannot become a saddle.
        if not same and (tolerance <= 0.0 or group[0] * K <= 0.0):
            groups.append([K])
            continue
        trial = [_on(problem, piece.panel, middle, piece.parts, arc) for piece in pieces if piece.K in group]
        if same or all(_astray(piece) <= tolerance for piece in trial):
            groups[-1] = group
            laid[group[0]] = trial
        else:
            groups.append([K])
    shared = {piece.panel.name: piece for trial in laid.values() for piece in trial}
    return [shared.get(piece.panel.name, piece) for piece in pieces]


def _astray(piece: _Laid) -> float:
    V = piece.parts.vertices[piece.parts.faces]
    return max(piece.there.gap, piece.there.edge_error * float(np.linalg.norm(np.roll(V, -1, axis=1) - V, axis=2).max()))


def _fitted(
    piece: _Laid,
    mould: Mould,
    evaluations: tuple[FloatArray, FloatArray],
    unbounded: dict[str, Mask],
    material: Material,
    thickness: float,
    unit: float,
) -> PanelFit:
    """Return the fit of a panel on its mould, rotated about the pole.

    On a mould that is not isotropic it is rotated to the least mean square change of its curvature. The stress at a corner is the larger
    one of two evaluations of the shape operators, so that the errors of one of them do not make it too small.
    """
    vertices, operators = piece.parts.vertices, evaluations[0]

    def changes_at(angle: float, operators: FloatArray = operators) -> FloatArray:
        return _changes(mould.surface, piece, space_form.rotation(angle), operators) / unit

    angle = _heading(piece.there.on_form, vertices)
    if not mould.surface.isotropic:
        angle = _least_angle(lambda turn: float(np.square(changes_at(turn)).mean()))
    motion = space_form.rotation(angle)
    places = _places(piece, mould.surface, motion)
    nearest = rigid_fits(places[None], vertices)
    changes = np.stack([changes_at(angle, own) for own in evaluations])
    stresses = 1e-6 * plate_stress(material, 1e-3 * thickness, changes).max(axis=0)
    causes = tuple(cause for cause, where in unbounded.items() if where[piece.parts.whole].any())
    return PanelFit(
        piece.panel,
        mould.number,
        piece.radius,
        1e3 * unit * piece.there.gap,
        piece.there.edge_error,
        1e3 * unit * nearest.most,
        float(np.abs(changes).max()),
        float(stresses.max()),
        piece.laid.turned(motion),
        vertices,
        piece.parts.faces,
        places,
        nearest,
        stresses.mean(axis=1)[piece.parts.within],
        1e3 * unit * _sag(piece.places, operators[piece.parts.own_faces]),
        causes,
    )


def _sag(places: FloatArray, operators: FloatArray) -> float:
    """Return the largest distance of edges from the smooth surface, by the normal curvature along them [L].

    Parameters
    ----------
    places
        (m, 3, 3) corners of faces [L].
    operators
        (m, 3, 3, 3) shape operators at the corners [1/L].
    """
    edges = np.roll(places, -1, axis=1) - places
    along = 0.5 * (operators + np.roll(operators, -1, axis=1))
    return float(np.abs(np.einsum("fei,feij,fej->fe", edges, along, edges)).max()) / 8.0


def _least_bending(pieces: list[_Laid], radius: float, operators: FloatArray) -> MouldSurface:
    """Return the mould on which the mean square change of curvature of panels of one K is least."""
    K = pieces[0].laid.K
    usual = surface_for(K, radius)
    if K == 0.0:
        return usual
    areas = np.array([face_areas(piece.parts.vertices, piece.parts.faces).sum() for piece in pieces])

    def change(surface: MouldSurface, piece: _Laid, turn: float) -> float:
        return float(np.square(_changes(surface, piece, space_form.rotation(turn), operators)).mean())

    def turns_on(surface: MouldSurface) -> list[float]:
        """Return the rotation of least bending of every panel."""
        if surface.isotropic:
            return [0.0] * len(pieces)
        return [_least_angle(lambda turn, piece=piece: change(surface, piece, turn)) for piece in pieces]  # type: ignore[misc]

    def bending(surface: MouldSurface, turns: list[float]) -> float:
        """Return the mean square change over all panels, infinite if a panel passes the edge of the mould [1/L^2]."""
        total = float(areas @ [change(surface, piece, turn) for piece, turn in zip(pieces, turns)])
        return total if math.isfinite(total) else math.inf

    found: list[tuple[float, MouldSurface]] = [(bending(usual, turns_on(usual)), usual)]
    for size in closest_sizes(K, radius, [_principal(piece, operators) for piece in pieces]):
        turns = turns_on(RevolvedMould(K, size))
        # Principal curvatures at the pole differ from those on the rest of a panel.
        best = minimize_scalar(
            lambda ratio, size=size, turns=turns: bending(RevolvedMould(K, size * math.exp(ratio)), turns),
            bounds=size_range(K, radius, size),
            method="bounded",
            options={"xatol": SIZE_TOLERANCE},
        )
        found.append((float(best.fun), RevolvedMould(K, size * math.exp(float(best.x)))))
    return min(found, key=lambda own: own[0])[1]


def _principal(piece: _Laid, operators: FloatArray) -> FloatArray:
    """Return the mean principal curvatures of a panel in position, the larger first (2,) [1/L]."""
    V = piece.places
    normals = np.cross(V[:, 1] - V[:, 0], V[:, 2] - V[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    side = -1.0 if piece.parts.turned else 1.0
    mean = side * np.einsum("f,fij->ij", areas / areas.sum(), operators[piece.parts.own_faces].mean(axis=1))
    normal = normals.sum(axis=0)
    own = principal_curvatures(mean[None], normal[None] / np.linalg.norm(normal))
    return np.array([own.larger[0], own.smaller[0]])


def _least_angle(bending: Callable[[float], float]) -> float:
    """Return the angle of least bending; angles half a turn apart differ too. At some the panel may pass the edge of the mould."""
    step = 2.0 * np.pi / ROTATIONS
    start = step * int(np.argmin(np.nan_to_num([bending(step * turn) for turn in range(ROTATIONS)], nan=np.inf)))
    found = minimize_scalar(bending, bounds=(start - step, start + step), method="bounded", options={"xatol": ANGLE_TOLERANCE})
    return float(found.x) if found.fun < bending(start) else start


def _places(piece: _Laid, surface: MouldSurface, motion: FloatArray) -> Vertices:
    """Return the vertices of a panel on its mould (p, 3) after a rotation about its pole.

    Vertices on joints lie on the chords of whole faces on a sphere, and on the surface itself on other moulds.
    """
    if not surface.isotropic or not piece.parts.cut:
        return surface.places(space_form.turned(piece.there.on_form, motion))
    lifted = piece.there.lifted
    return space_form.lifted_places(np.column_stack([lifted[:, 0], lifted[:, 1:] @ motion[1:, 1:].T]), surface.K)


def _heading(points: FloatArray, there: FloatArray) -> float:
    """Return the rotation angle about the pole that best aligns points (p, 3) with the plan of `there` (p, 3)."""
    here, away = points[:, 1:] - points[:, 1:].mean(axis=0), there[:, :2] - there[:, :2].mean(axis=0)
    cross = np.einsum("i,i", here[:, 0], away[:, 1]) - np.einsum("i,i", here[:, 1], away[:, 0])
    return math.atan2(cross, np.einsum("ij,ij", here, away))


def _changes(surface: MouldSurface, piece: _Laid, motion: FloatArray, operators: FloatArray) -> FloatArray:
    """Return the principal changes of curvature at the corners of the whole faces of a panel, from mould to position (m, 3, 2) [1/L]."""
    parts, laid = piece.parts, piece.laid
    corners = space_form.turned(laid.points, motion)[laid.faces]
    side = -1.0 if parts.turned else 1.0
    return curvature_changes(surface, corners, piece.places, side * operators[parts.own_faces])
