"""Fig. 1: the kinematic pair of gears, drawn with the symbols of the model."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, Polygon, Rectangle

from gearmesh.reproduction.figures import palette
from gearmesh.reproduction.figures.canvas import WIDTH, styled

CENTRE_3, CENTRE_2 = np.array((-1.75, -1.0)), np.array((1.75, 1.0))
"""Centres of the wheels, in base radii; the wheels are drawn apart to make room for the mesh."""

Place = tuple[float, float] | np.ndarray
"""A point of the drawing."""

TEETH = 21
PRESSURE_ANGLE = np.radians(20.0)
TINTS = {3: "#dfe9f2", 2: "#f8e6dc"}
_LINE = {"color": palette.INK, "lw": 0.9, "solid_capstyle": "butt"}


@styled
def draw() -> Figure:
    """Draw the pair, its mesh and its bearings, and beside it C(t) and the elastic force."""
    figure = Figure(figsize=(WIDTH, 5.9))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(-4.15, 4.15), ylim=(-3.4, 3.4), aspect="equal")
    axes.set_axis_off()
    axes.plot((-3.2, 3.2), (0, 0), color=palette.GREY, lw=0.6, ls=(0, (8, 3, 1, 3)), zorder=0)
    axes.text(3.22, 0.0, " mesh line", va="center", fontsize=8, color=palette.GREY)
    for number, centre, outward in ((3, CENTRE_3, -1), (2, CENTRE_2, 1)):
        _draw_wheel(axes, number, centre, outward)
        _draw_bearings(axes, number, centre, outward)
    _draw_mesh(axes)
    _draw_frame_of_reference(axes, np.array((3.1, -0.95)))
    _draw_stiffness(figure.add_axes((0.085, 0.765, 0.30, 0.175)))
    _draw_elastic_force(figure.add_axes((0.665, 0.085, 0.30, 0.21)))
    return figure


def _draw_wheel(axes: Axes, number: int, centre: np.ndarray, outward: int) -> None:
    axes.add_patch(Polygon(centre + _gear_outline(), fc=TINTS[number], ec=palette.PALE, lw=0.6))
    axes.add_patch(Circle(centre, 1.0, fill=False, ec=palette.INK, lw=0.8, ls=(0, (5, 2))))
    contact = np.array((centre[0], 0.0))
    axes.plot(*np.transpose((centre, contact)), color=palette.GREY, lw=0.6)
    side = "right" if outward < 0 else "left"
    _write(axes, centre - outward * np.array((-0.07, 0.76)), f"$R_{{b{number}}}$", ha=side)
    shift = 0.24 * np.array((np.cos(0.6), np.sin(0.6)))
    axes.plot(*np.transpose((centre, centre + shift)), color=palette.INK, lw=1.1)
    axes.add_patch(Circle(centre, 0.055, fc="white", ec=palette.INK, lw=0.9, zorder=5))
    axes.add_patch(Circle(centre + shift, 0.035, fc=palette.INK, lw=0, zorder=5))
    _write(axes, centre + shift + (0.06, 0.03), f"$e_{number}$", ha="left", va="center")
    _write(axes, centre - np.array((0.42, 0.5)), f"$m,\\ J_{number}$", color=palette.GREY)
    _turn(axes, centre, 0.55, (200, 115), f"$M_{number}$", palette.RED)
    _turn(axes, centre, 0.8, (75, 15), f"$\\varphi_{number}$", palette.BLUE)


def _gear_outline() -> np.ndarray:
    """Return the outline of a wheel of base radius one with involute flanks."""
    pitch = 1.0 / np.cos(PRESSURE_ANGLE)
    module = 2.0 * pitch / TEETH
    radius = np.linspace(1.0, pitch + module, 8)
    angle = np.arccos(1.0 / radius)
    involute = np.tan(angle) - angle
    half = np.pi / (2 * TEETH) + np.tan(PRESSURE_ANGLE) - PRESSURE_ANGLE - involute
    root = pitch - 1.25 * module
    flank = np.column_stack((np.append(root, radius), np.append(half[0], half)))
    tooth = np.concatenate((flank * (1, -1), flank[::-1]))
    turns = 2 * np.pi * (np.arange(TEETH) + 0.25) / TEETH
    r, theta = np.concatenate([tooth + np.array((0, turn)) for turn in turns]).T
    return np.column_stack((r * np.cos(theta), r * np.sin(theta)))


def _draw_bearings(axes: Axes, number: int, centre: np.ndarray, outward: int) -> None:
    """Draw spring and damper to the frame along y and along z."""
    for direction, name in ((np.array((outward, 0.0)), "y"), (np.array((0.0, outward)), "z")):
        near, far = centre + 1.3 * direction, centre + 2.12 * direction
        across = np.array((-direction[1], direction[0]))
        axes.plot(*np.transpose((centre, near)), zorder=3, **_LINE)
        axes.plot(*np.transpose((near - 0.22 * across, near + 0.22 * across)), zorder=3, **_LINE)
        _spring(axes, near + 0.2 * across, far + 0.2 * across)
        _damper(axes, near - 0.2 * across, far - 0.2 * across)
        _ground(axes, far, direction)
        middle = 0.5 * (near + far)
        _write(axes, middle + 0.42 * across, "$c_b$")
        _write(axes, middle - 0.42 * across, "$b_b$")
        tip = centre + 0.5 * np.abs(direction)
        axes.add_patch(_arrow(centre, tip, palette.INK))
        _write(axes, tip - 0.14 * np.abs(across), f"${name}_{number}$")


def _draw_mesh(axes: Axes) -> None:
    """Draw stiffness, damping and backlash on the mesh line."""
    left, right = CENTRE_3[0], CENTRE_2[0]
    start, end, jaw = -0.8, 0.2, 0.62
    for x in (left, right):
        axes.add_patch(Circle((x, 0), 0.045, fc=palette.INK, lw=0, zorder=6))
    axes.plot((left, start), (0, 0), **_LINE)
    axes.plot((start, start), (-0.3, 0.3), **_LINE)
    axes.plot((end, end), (-0.3, 0.3), **_LINE)
    _spring(axes, np.array((start, 0.26)), np.array((end, 0.26)), palette.RED, 1.2)
    _damper(axes, np.array((start, -0.26)), np.array((end, -0.26)))
    _write(axes, (0.5 * (start + end), 0.52), "$C(t)$", color=palette.RED)
    _write(axes, (0.5 * (start + end) + 0.1, -0.56), "$k_i\\,,\\ k_{im}$")
    axes.plot((end, jaw), (0, 0), **_LINE)
    axes.plot((jaw, jaw), (-0.13, 0.13), color=palette.INK, lw=2.2, solid_capstyle="butt")
    mouth, back = 0.4, 0.84
    for side in (-1, 1):
        outline = ((mouth, 0.05), (mouth, 0.3), (back, 0.3), (back, 0.0))
        axes.plot(*np.transpose([(x, side * y) for x, y in outline]), **_LINE)
    axes.plot((back, right), (0, 0), **_LINE)
    for x in (mouth, jaw):
        axes.plot((x, x), (0.34, 0.58), color=palette.GREY, lw=0.5)
    axes.add_patch(_arrow((mouth, 0.5), (jaw, 0.5), palette.GREY, style="<|-|>", size=5))
    _write(axes, (0.5 * (mouth + jaw), 0.68), "$s(t)$")


def _draw_frame_of_reference(axes: Axes, origin: np.ndarray) -> None:
    for tip, name in (((0.5, 0.0), "$y$"), ((0.0, 0.5), "$z$")):
        axes.add_patch(_arrow(origin, origin + tip, palette.GREY))
        _write(axes, origin + 1.25 * np.array(tip), name, color=palette.GREY)


def _draw_stiffness(axes: Axes) -> None:
    """Draw C(t) over two mesh periods."""
    low, high, half = 0.5879, 1.0, 0.5 * (1.569 - 1.0)
    time = np.array((-half, half, 1 - half, 1 + half, 2 - half, 2 + half))
    axes.step(time, (high, low, high, low, high, high), where="post", color=palette.RED)
    axes.set(xlim=(-half, 2 + half), ylim=(0, 1.32))
    axes.set_yticks((low, high), ("$C_{\\min}$", "$C_{\\max}$"))
    axes.set_xticks((0, 1, 2), ("0", "$T$", "2$T$"))
    axes.axhline(low + (high - low) * 2 * half, color=palette.GREY, lw=0.6, ls=(0, (4, 2)))
    axes.text(1.5, low + 0.27, "$C_s$", fontsize=8, color=palette.GREY, ha="center")
    axes.annotate("", (-half, 1.12), (half, 1.12), arrowprops=_DIMENSION)
    axes.text(0, 1.15, "$(\\varepsilon-1)T$", ha="center", fontsize=8)
    axes.set_xlabel("$t$", loc="right", labelpad=-9)
    axes.set_title("mesh stiffness $C(t)$")
    _plain(axes)


def _draw_elastic_force(axes: Axes) -> None:
    """Draw the elastic force over the relative motion, with the regions."""
    s = 1.0
    axes.set(xlim=(-1.9, 0.9), ylim=(-0.75, 0.95))
    axes.axvspan(-s, 0, color=palette.CONTACT_LOSS, lw=0)
    axes.axvspan(-1.9, -s, color=palette.INVERSE_MESH, lw=0)
    axes.plot((-1.9, -s, 0, 0.9), (-0.72, 0, 0, 0.72), color=palette.INK, lw=1.3)
    axes.set_xticks((-s, 0), ("$-s$", "0"))
    axes.set_yticks((0,), ("0",))
    for x, text in ((-1.45, "inverse\nmesh"), (-0.5, "contact\nloss"), (0.45, "normal\nmesh")):
        axes.text(x, 0.9, text, ha="center", va="top", fontsize=7.5, linespacing=1.1)
    axes.set_xlabel("$y$", loc="right", labelpad=-9)
    axes.set_title("elastic force over relative motion")
    _plain(axes)


_DIMENSION = {
    "arrowstyle": "<|-|>",
    "color": palette.GREY,
    "lw": 0.5,
    "mutation_scale": 5,
    "shrinkA": 0,
    "shrinkB": 0,
}


def _plain(axes: Axes) -> None:
    axes.tick_params(top=False, right=False)
    axes.spines[["top", "right"]].set_visible(False)
    axes.patch.set_alpha(0.0)


def _write(axes: Axes, place: Place, text: str, **look: object) -> None:
    axes.text(place[0], place[1], text, **{"ha": "center", "va": "center", "fontsize": 10, **look})


def _arrow(
    start: Place, end: Place, colour: str, style: str = "-|>", size: float = 8
) -> FancyArrowPatch:
    return FancyArrowPatch(
        start, end, arrowstyle=style, mutation_scale=size, color=colour, lw=0.9,
        shrinkA=0, shrinkB=0, zorder=4,
    )  # fmt: skip


def _turn(
    axes: Axes, centre: np.ndarray, radius: float, degrees: tuple[int, int], name: str, colour: str
) -> None:
    """Draw a clockwise arrow about `centre` and its name in the middle of the arc."""
    angle = np.radians(np.linspace(*degrees, 40))
    arc = centre + radius * np.column_stack((np.cos(angle), np.sin(angle)))
    axes.plot(*arc[:-2].T, color=colour, lw=1.3, zorder=4)
    axes.add_patch(_arrow(arc[-4], arc[-1], colour, size=10))
    middle = 0.5 * np.radians(sum(degrees))
    label = centre + (radius - 0.16) * np.array((np.cos(middle), np.sin(middle)))
    _write(axes, label, name, color=colour)


def _spring(
    axes: Axes, start: Place, end: Place, colour: str = palette.INK, width: float = 0.9
) -> None:
    along = np.array((0, 0.14, *np.linspace(0.18, 0.82, 13), 0.86, 1))
    swing = np.array((0, 0, *(0.085 * (-1.0) ** np.arange(13)), 0, 0))
    swing[2] = swing[-3] = 0.0
    direction = np.subtract(end, start)
    across = np.array((-direction[1], direction[0])) / np.hypot(*direction)
    points = start + along[:, None] * direction + swing[:, None] * across
    axes.plot(*points.T, color=colour, lw=width, solid_joinstyle="round", zorder=3)


def _damper(axes: Axes, start: Place, end: Place) -> None:
    direction = np.subtract(end, start)
    across = 0.09 * np.array((-direction[1], direction[0])) / np.hypot(*direction)

    def at(share: float, side: float = 0.0) -> np.ndarray:
        return np.asarray(start + share * direction + side * across)

    cup = (at(0.68, 1), at(0.38, 1), at(0.38, -1), at(0.68, -1))
    axes.add_patch(Polygon(cup, fc="white", lw=0, zorder=2.5))
    axes.plot(*np.transpose(cup), zorder=3, **_LINE)
    axes.plot(*np.transpose((at(0), at(0.38))), zorder=3, **_LINE)
    axes.plot(*np.transpose((at(0.55, 0.75), at(0.55, -0.75))), zorder=3, **_LINE)
    axes.plot(*np.transpose((at(0.55), at(1))), zorder=3, **_LINE)


def _ground(axes: Axes, place: np.ndarray, direction: np.ndarray) -> None:
    across = np.abs(np.array((-direction[1], direction[0])))
    corner = place - 0.36 * across
    size = 0.72 * across + 0.12 * direction
    axes.add_patch(
        Rectangle(corner, *size, fc="none", ec=palette.PALE, lw=0, hatch="//////", zorder=1)
    )
    axes.plot(*np.transpose((corner, corner + 0.72 * across)), zorder=3, **_LINE)
