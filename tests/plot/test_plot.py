"""Pictures: what is drawn is what the arrays say, nothing is cut off, and files come out whole."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from compas_cgc import plot
from compas_cgc.errors import CGCError
from compas_cgc.errors import FileError
from compas_cgc.errors import MeshError
from compas_cgc.meshing import face_regions
from compas_cgc.meshing.visibility import in_sight
from compas_cgc.model.result import History
from compas_cgc.model.roles import CREASE
from compas_cgc.model.roles import DUMMY
from compas_cgc.model.roles import FIXED
from compas_cgc.model.roles import INTERNAL
from compas_cgc.plot.colours import limit_above
from compas_cgc.plot.studio_light import _tones
from compas_cgc.plot.view import project
from compas_cgc.solvers.flow import curve_flow

from ..support import shapes
from ..support.roofs import irregular_disk

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
SQUARE = np.array([[0, 1, 2], [0, 2, 3]])


def roof(n: int = 8, height: float = 0.2) -> plot.Shape:
    """A bulging square of side 1 in n x n squares, fixed corners, a ring of dummies and a crease along the middle."""
    i, j = (index.ravel() for index in np.meshgrid(np.arange(n + 3), np.arange(n + 3), indexing="ij"))
    x, y = (i - 1) / n, (j - 1) / n
    inside = (np.abs(x - 0.5) <= 0.5) & (np.abs(y - 0.5) <= 0.5)
    z = np.where(inside, height * np.sin(np.pi * x) * np.sin(np.pi * y), 0.0)
    a = (i * (n + 3) + j)[(i < n + 2) & (j < n + 2)]
    faces = np.concatenate([np.stack([a, a + n + 3, a + n + 4], 1), np.stack([a, a + n + 4, a + 1], 1)])
    roles = np.where(i == n // 2 + 1, CREASE, INTERNAL)
    roles[np.isin(x, (0, 1)) & np.isin(y, (0, 1))] = FIXED
    roles[~inside] = DUMMY
    line = np.flatnonzero((i == n // 2 + 1) & inside)
    return plot.Shape("Roof", np.stack([x, y, z], 1), faces, roles, np.stack([line[:-1], line[1:]], 1))


def pixels(figure) -> np.ndarray:
    """Return what is seen of a figure, (height, width, 3) in 0..255."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].astype(int)


def pixel(ax, point) -> np.ndarray:
    """Return the colour seen at a point of the sheet."""
    image = pixels(ax.figure)
    x, y = ax.transData.transform(point)
    return image[image.shape[0] - 1 - int(y), int(x)]


def red(image: np.ndarray) -> np.ndarray:
    return (image[..., 0] > 180) & (image[..., 1] < 90) & (image[..., 2] < 90)


def fake_history(energy, error_norm) -> History:
    return History.from_rows([(e, k, k, 0.1, 1, True) for e, k in zip(energy, error_norm)])


class TestMatplotlibIsOptional:
    def test_it_is_imported_by_drawing_only_and_pyplot_never(self):
        code = """
import sys
import compas_cgc.plot as plot
print("matplotlib" in sys.modules)
figure = plot.draw_shape([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], [0, 0, 0]).figure
figure.savefig(__import__("io").BytesIO())
print("matplotlib" in sys.modules, "matplotlib.pyplot" in sys.modules)
"""
        out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert out.stdout.split() == ["False", "True", "False"]

    def test_without_it_one_sentence_says_what_to_install(self, monkeypatch):
        for name in [name for name in sys.modules if name.split(".")[0] == "matplotlib"]:
            monkeypatch.delitem(sys.modules, name)
        monkeypatch.setitem(sys.modules, "matplotlib", None)
        curve = np.array([[0.0, 0.0], [1.0, 1.0]])
        for draw in (
            lambda: plot.draw_shape(CORNERS, SQUARE, np.zeros(4)),
            lambda: plot.history_figure(fake_history([1], [1])),
            lambda: plot.draw_curve(curve),
            lambda: plot.studio(*roof()[1:5], width=80),
            lambda: plot.error_figure([roof()._replace(errors=np.zeros(121))]),
        ):
            with pytest.raises(CGCError) as caught:
                draw()
            assert str(caught.value) == 'drawing requires matplotlib: pip install "compas_cgc[plot]"'


class TestViews:
    def test_the_plan_shows_x_to_the_right_and_y_up(self):
        seen = project(CORNERS + [0, 0, 5], plot.VIEWS["plan"], CORNERS)
        assert np.allclose(seen[:, :2], CORNERS[:, :2], atol=1e-12)
        assert np.allclose(seen[:, 2], 5)

    def test_the_diagonal_view_is_from_above_and_true_to_length_across(self):
        up, toward = project(np.array([[0, 0, 1.0], [1.0, -1.0, 0]]), plot.VIEWS["diagonal"], CORNERS)
        assert up[0] == pytest.approx(0) and up[1] == pytest.approx(np.cos(np.pi / 6))
        assert toward[1] < 0 < toward[2]

    def test_a_perspective_enlarges_what_is_near_and_keeps_planes(self):
        view = plot.View(30.0, 25.0, 2.0)
        rng = np.random.default_rng(1)
        plane = rng.random((6, 2)) @ rng.random((2, 3))
        seen = project(plane, view, CORNERS)
        assert np.linalg.matrix_rank(seen[1:] - seen[0], tol=1e-9) == 2
        eye = project(np.eye(3), plot.View(30.0, 25.0), CORNERS)[:, 2]
        lengths = [np.linalg.norm(np.diff(project(CORNERS[:2] + shift * eye, view, CORNERS)[:, :2], axis=0)) for shift in (-0.3, 0.0, 0.3)]
        assert lengths == sorted(lengths) and lengths[0] < lengths[2]

    def test_an_unknown_view_is_named(self):
        with pytest.raises(ValueError, match="diagonal, plan or a View, not 'side'"):
            plot.draw_shape(CORNERS, SQUARE, np.zeros(4), view="side")


class TestHiddenSurfaces:
    @pytest.mark.parametrize("z, expected", [(-0.5, "white"), (0.5, "grey")])
    def test_of_two_squares_the_upper_one_is_seen(self, z, expected):
        vertices = np.concatenate([CORNERS, CORNERS + [0, 0, z]])
        roles = np.array([INTERNAL] * 4 + [DUMMY] * 4)
        for order in (np.concatenate([SQUARE, SQUARE + 4]), np.concatenate([SQUARE + 4, SQUARE])):
            colour = pixel(plot.draw_shape(vertices, order, roles, view="plan"), (0.7, 0.4))
            assert (colour.min() > 250) == (expected == "white"), colour

    def test_a_point_is_hidden_by_a_face_in_front_but_not_by_one_behind_or_beside(self):
        points = np.array([[0.5, 0.4, -1.0], [0.5, 0.4, 1.0], [1.5, 0.4, -1.0], [0.5, 0.4, 0.0], [1.0, 1.0, 0.0]])
        assert in_sight(points, CORNERS, SQUARE).tolist() == [False, True, True, True, True]

    def test_supports_in_sight_are_red_dots_and_those_behind_a_roof_are_not_drawn(self):
        def dots(height):
            shape = roof(12, height)
            alone = plot.View(-45.0, 12.0)
            return red(pixels(plot.draw_shape(*shape[1:4], view=alone).figure)).sum()

        flat, high = dots(0.0), dots(1.5)
        assert flat > 400
        assert high == pytest.approx(0.75 * flat, rel=0.15), "the far corner of four is behind the roof"

    def test_dummies_do_not_hide_supports(self):
        vertices = np.concatenate([CORNERS, [[-1, -1, 0.5], [2, -1, 0.5], [-1, 2, 0.5]]])
        roles = np.array([FIXED, INTERNAL, INTERNAL, INTERNAL, DUMMY, DUMMY, DUMMY])
        assert red(pixels(plot.draw_shape(vertices, [*SQUARE, [4, 5, 6]], roles, view="plan").figure)).any()

    def test_a_crease_is_a_thick_line_on_its_edges(self):
        shape = roof(8, 0.0)
        with_crease = plot.draw_shape(*shape[1:5], view="plan")
        assert pixel(with_crease, (0.502, 0.31)).max() < 60
        assert pixel(plot.draw_shape(*shape[1:4], view="plan"), (0.502, 0.31)).min() > 200


class TestWholeFigures:
    history = fake_history(np.linspace(2, 1, 50), np.geomspace(1, 1e-9, 50))
    curves = [("a", np.array([[0, 0], [0.5, 1], [1, 0]]), np.array([[0, 0], [0, 1], [0, 0]])), ("b", np.array([[0.0, 0], [1, 0]]))]

    @pytest.mark.parametrize("height", [0.0, 0.2, 3.0])
    def test_nothing_is_cut_off(self, height):
        shape = roof(height=height)
        shape = shape._replace(errors=shape.vertices[:, 0] * 1e-7)
        for figure in (
            plot.shape_figure([shape, shape], unit="m"),
            plot.comparison_figure([shape] * 3),
            plot.error_figure([shape, shape], "diagonal", unit="m"),
            plot.draw_shape(*shape[1:5]).figure,
            plot.draw_curvature(*shape[1:4], shape.errors).figure,
            plot.history_figure(self.history, "Example", unit="m"),
            plot.curve_figure(self.curves, "Curves"),
        ):
            image = pixels(figure)
            rim = np.concatenate([image[0], image[-1], image[:, 0], image[:, -1]])
            assert rim.min() > 245
            assert image.min() < 100

    def test_panels_of_a_figure_have_one_scale(self):
        shape = roof()
        figure = plot.comparison_figure([shape, shape._replace(vertices=2 * shape.vertices)], view="plan", dummies=False)
        pixels(figure)
        small, large = (np.ptp(ax.transData.transform([[0, 0], [1, 0]])[:, 0]) for ax in figure.axes)
        assert small == pytest.approx(large)

    def test_captions_are_those_of_the_paper(self):
        texts = [text.get_text() for ax in plot.shape_figure([roof()]).axes for text in ax.texts]
        assert texts[:2] == ["(a) diagonal view", "Roof"] and texts[2] == "(b) plan view"

    def test_a_drawing_goes_on_axes_of_ones_own(self):
        from matplotlib.figure import Figure

        left, right = Figure().subplots(1, 2)
        assert plot.draw_shape(*roof()[1:5], ax=left) is left
        assert plot.draw_error(*roof()[1:4], np.ones(121), ax=right) is right
        assert left.get_aspect() == right.get_aspect() == 1.0

    def test_from_ten_to_twenty_thousand_faces(self):
        for n in (2, 100):
            shape = roof(n)
            image = pixels(plot.draw_shape(*shape[1:5]).figure)
            assert image.mean() > 150, "edges of a fine mesh do not blacken it"

    def test_a_figure_of_nothing_is_refused(self):
        for figure in (plot.shape_figure, plot.comparison_figure, plot.error_figure, plot.curve_figure):
            with pytest.raises(ValueError, match=f"{figure.__name__} requires at least one"):
                figure([])


class TestMaps:
    def test_positive_is_red_negative_blue_and_what_is_not_asked_grey(self):
        shape = roof(8, 0.0)
        x, y, _ = shape.vertices.T
        errors = np.where(x < 0.3, 1e-3, -1e-3)
        ax = plot.draw_error(*shape[1:4], errors)
        off = np.array([0.02, 0.03])  # away from the edges' lines
        r, g, b = pixel(ax, off + [0.25, 0.5])
        assert r > 2 * max(g, b)
        r, g, b = pixel(ax, off + [0.75, 0.5])
        assert b > 2 * max(r, g)
        r, g, b = pixel(ax, off + [0.5, 0.5])
        assert r == g == b, "a crease is not asked"

    def test_the_scale_is_symmetric_round_and_names_its_power_and_unit(self):
        ax = plot.draw_error(*roof()[1:4], np.full(121, 4.7e-7), unit="mm")
        (bar,) = ax.child_axes
        assert bar.get_ylim() == pytest.approx((-5e-7, 5e-7))
        assert [tick.get_text() for tick in bar.get_yticklabels()] == ["−5", "−2.5", "0", "2.5", "5"]
        assert {text.get_text() for text in bar.texts} == {r"$\times 10^{-7}$", r"$K-\bar K$ [1/mm²]"}

    def test_values_beyond_the_internal_vertices_do_not_stretch_the_scale(self):
        shape = roof()
        errors = np.where(shape.roles == INTERNAL, 0.5, 1e9)
        assert plot.draw_error(*shape[1:4], errors).child_axes[0].get_ylim()[1] == 0.5

    def test_the_curvature_map_shows_every_known_value(self):
        K = np.where(roof().roles == CREASE, -3.0, np.nan)
        ax = plot.draw_curvature(*roof(8, 0.0)[1:4], K)
        r, g, b = pixel(ax, [0.52, 0.53])
        assert b > 2 * max(r, g)
        r, g, b = pixel(ax, [0.27, 0.53])
        assert r == g == b

    def test_one_value_per_vertex(self):
        with pytest.raises(ValueError, match=r"errors must be one per vertex \(121\), not of shape \(3,\)"):
            plot.draw_error(*roof()[1:4], np.zeros(3))
        with pytest.raises(ValueError, match="requires errors, but 'Roof' has none"):
            plot.error_figure([roof()])

    @pytest.mark.parametrize("largest, limit", [(0.0, 1.0), (0.93, 1.0), (1.0, 1.0), (-4.7e-7, 5e-7), (np.nan, 1.0), (1234.0, 1600.0)])
    def test_limits_are_round(self, largest, limit):
        assert limit_above(np.array([0.0, largest])) == pytest.approx(limit)


class TestHistories:
    def test_energy_is_linear_and_the_error_norm_logarithmic_over_the_steps(self):
        energy, error = plot.draw_history(fake_history([3, 2, 1], [1, 0.1, 0.01]), unit="m")
        assert (energy.get_yscale(), error.get_yscale()) == ("linear", "log")
        assert (energy.get_ylabel(), error.get_ylabel()) == ("Energy functional [m]", r"Error norm $\kappa$ [1/m²]")
        assert energy.get_xlabel() == error.get_xlabel() == "Steps"
        assert energy.lines[0].get_xydata().tolist() == [[1, 3], [2, 2], [3, 1]]
        assert error.lines[0].get_ydata().tolist() == [1, 0.1, 0.01]

    def test_zeros_and_explosions_leave_a_gap(self):
        energy, error = plot.draw_history(fake_history([3, np.inf, 1], [1, 0.0, np.nan]))
        assert np.isnan(energy.lines[0].get_ydata()).tolist() == [False, True, False]
        assert np.isnan(error.lines[0].get_ydata()).tolist() == [False, True, True]
        pixels(energy.figure)

    def test_no_steps_are_said_in_words(self):
        energy, error = plot.draw_history(History.from_rows([]))
        assert energy.texts[0].get_text() == error.texts[0].get_text() == "no steps were taken"
        pixels(energy.figure)


class TestCurves:
    def test_arrows_point_along_the_gradient_and_the_largest_has_one_length_however_small_it_is(self):
        line = np.column_stack([np.linspace(0, 2, 21), np.zeros(21)])
        for steps in (3, 300):
            result = curve_flow(line, 0.2, crease=10, s=0.8, steps=steps)
            ax = plot.draw_curve(result.points, result.gradient, breaks=(10,))
            (arrows,) = ax.collections
            length = np.hypot(arrows.U, arrows.V)
            assert length.max() == pytest.approx(0.12 * np.ptp(result.points[:, 0]))
            drawn = np.argmin(np.linalg.norm(result.points[:, None] - arrows.get_offsets(), axis=2), axis=0)
            G = result.gradient[drawn]
            assert np.allclose(arrows.U * G[:, 1], arrows.V * G[:, 0], atol=1e-12) and (arrows.U * G[:, 0] + arrows.V * G[:, 1] > 0).all()

    def test_fixed_ends_are_red_and_no_gradient_means_no_arrow(self):
        ax = plot.draw_curve([[0, 0], [1, 0.5], [2, 0]], np.zeros((3, 2)))
        assert not ax.collections
        assert red(pixel(ax, (0, 0))) and red(pixel(ax, (2, 0))) and not red(pixel(ax, (1, 0.5)))

    def test_wrong_shapes_are_named(self):
        with pytest.raises(ValueError, match=r"points must have the shape \(n, 2\)"):
            plot.draw_curve(CORNERS)
        with pytest.raises(ValueError, match="gradient must be one vector per point"):
            plot.draw_curve(CORNERS[:, :2], np.zeros(4))


class TestStudio:
    def test_it_shows_no_dummies(self, small_pictures):
        shape = roof()
        image = plot.studio_image(*shape[1:5], width=80)
        lowered = shape._replace(vertices=np.where((shape.roles == DUMMY)[:, None], shape.vertices * [9, 9, 1], shape.vertices))
        assert np.array_equal(image, plot.studio_image(*lowered[1:5], width=80))

    def test_creases_divide_the_mesh_and_neighbours_differ_in_tone(self):
        shape = roof()
        real = shape.faces[~(shape.roles == DUMMY)[shape.faces].any(axis=1)]
        regions = face_regions(real, shape.creases[:, ::-1])
        left = shape.vertices[real].mean(axis=1)[:, 0] < 0.5
        assert len(np.unique(regions)) == 2 and np.array_equal(regions == regions[left][0], left)
        assert np.array_equal(_tones(real, regions) == _tones(real, regions)[left][0], left)
        assert not face_regions(real, np.empty((0, 2), int)).any()

    def test_eight_sectors_take_two_tones_in_whatever_order_they_are_numbered(self):
        faces = np.array([[0, i + 1, (i + 1) % 8 + 1] for i in range(8)])
        numbers = np.array([0, 2, 3, 1, 4, 5, 6, 7])
        tone = _tones(faces, numbers)
        assert set(tone) == {0, 1} and (tone != np.roll(tone, 1)).all()

    def test_curvature_beside_creases_and_supports_is_not_read(self, small_pictures):
        shape = roof()
        K = np.where(shape.roles == INTERNAL, 1.0, -1e6)
        image, same = (plot.studio_image(*shape[1:5], curvature=own, width=80) for own in (K, np.ones(len(K))))
        assert np.array_equal(image, same)

    def test_one_curvature_per_vertex(self):
        with pytest.raises(ValueError, match="curvature must be one per vertex"):
            plot.studio_image(*roof()[1:5], curvature=[1.0, 2.0], width=80)


class TestSaving:
    @pytest.mark.parametrize("name", ["a.png", "a.svg", "a.pdf", "A.PNG"])
    def test_the_same_picture_gives_the_same_bytes_and_leaves_nothing_beside_it(self, tmp_path, name):
        path = tmp_path / name
        path.write_text("an older picture")
        contents = []
        for _ in range(2):
            assert plot.save(plot.shape_figure([roof()]), path) == path
            contents.append(path.read_bytes())
        assert contents[0] == contents[1]
        begins = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}
        assert contents[0].startswith(begins[path.suffix.lower()])
        assert b"<dc:date>" not in contents[0] and b"matplotlib" not in contents[0].lower()[:300]
        assert [entry.name for entry in tmp_path.iterdir()] == [name]

    def test_a_failure_keeps_the_older_picture(self, tmp_path, monkeypatch):
        figure = plot.history_figure(TestWholeFigures.history)
        path = tmp_path / "a.png"
        path.write_text("an older picture")

        def full_disk(part, content):
            part.write_text("half a picture")
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(type(path), "write_bytes", full_disk)
        with pytest.raises(FileError, match="No space left"):
            plot.save(figure, path)
        assert path.read_text() == "an older picture"
        assert list(tmp_path.iterdir()) == [path]

    def test_other_suffixes_and_places_that_are_no_folder_are_named(self, tmp_path):
        figure = plot.draw_shape(CORNERS, SQUARE, np.zeros(4)).figure
        with pytest.raises(FileError, match="one of .png, .svg, .pdf, not that of 'a.gif'"):
            plot.save(figure, tmp_path / "a.gif")
        (tmp_path / "file").write_text("no folder")
        with pytest.raises(FileError, match="cannot be written"):
            plot.save(figure, tmp_path / "file" / "a.png")


class TestWhatIsRefused:
    def test_meshes_that_are_none(self):
        with pytest.raises(MeshError, match="not a finite number"):
            plot.draw_shape(CORNERS * [1, 1, np.nan], SQUARE, np.zeros(4))
        with pytest.raises(MeshError, match=r"roles must be one per vertex \(4\)"):
            plot.draw_shape(CORNERS, SQUARE, np.zeros(3))
        with pytest.raises(MeshError, match="a crease refers to a vertex that does not exist"):
            plot.draw_shape(CORNERS, SQUARE, np.zeros(4), [[0, 9]])

    def test_an_empty_mesh_is_an_empty_picture(self):
        assert pixels(plot.draw_shape(CORNERS, np.zeros((0, 3), int), np.zeros(4)).figure).min() == 255


def greys(ax):
    colours = ax.collections[0].get_facecolors()
    return colours[colours[:, 3] > 0.0, 0]  # of faces: lines are filled with nothing


def test_zebra_stripes_of_a_ball_are_those_of_planes_across_the_sky_on_an_irregular_mesh():
    flat = irregular_disk(300)
    x, y = flat.vertices[:, :2].T
    vertices = np.column_stack([x, y, np.sqrt(100.0 - x**2 - y**2)])
    drawn = plot.draw_zebra(vertices, flat.faces, np.zeros(len(x), int), view="plan", stripes=6.0).collections[0]
    colours = drawn.get_facecolors()
    filled = colours[:, 3] > 0.0
    corners = np.array([path.vertices[:3] for path, own in zip(drawn.get_paths(), filled) if own])
    dark = colours[filled, 0] < 0.3
    # What the ball mirrors from above: its normals are known everywhere.
    nx, nz = 0.1 * corners[..., 0], np.sqrt(1.0 - 0.01 * (corners**2).sum(axis=2))
    wave = np.sin(np.pi * 6.0 * 2.0 * nz * nx)
    inside = np.hypot(*corners.mean(axis=1).T) < 5.0
    assert np.count_nonzero(dark & inside) > 1000
    # Smooth: no corner of a stripe is off its edge by more than four per cent of its width.
    assert (np.where(dark[:, None], wave, -wave)[inside] < np.sin(0.04 * np.pi)).all()


def test_zebra_stripes_are_smooth_on_a_dome_and_break_at_its_creases():
    vertices, faces = shapes.grid(12)
    x, y = vertices[:, :2].T - 0.5
    vertices[:, 2] = 0.3 - 0.6 * (x**2 + y**2)
    roles = np.zeros(len(vertices), int)
    dome = greys(plot.draw_zebra(vertices, faces, roles))
    assert (dome < 0.2).any() and (dome > 0.6).any(), "both stripes are there"
    flat = vertices * [1, 1, 0]
    assert np.ptp(greys(plot.draw_zebra(flat, faces, roles))) < 1e-9, "a plane shows one place of the sky"
    ridge = vertices.copy()
    ridge[:, 2] = 0.4 * np.abs(x)
    line = np.flatnonzero(np.abs(x) < 1e-9)
    line = line[np.argsort(vertices[line, 1])]
    creased = greys(plot.draw_zebra(ridge, faces, roles, np.column_stack([line[:-1], line[1:]])))
    assert len(np.unique(np.round(creased, 6))) <= 3 < len(np.unique(np.round(greys(plot.draw_zebra(ridge, faces, roles)), 6)))
