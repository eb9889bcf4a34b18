"""Made-up runs in the format of a trajectory: smooth motion, and impacts shorter than the output step."""

import itertools
import json
from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg

from antenna_pin import load_scenario, simulate

CONTACTS = ["elevation.radial+", "elevation.radial-", "elevation.axial+", "elevation.axial-"]
INERTIA = 0.689  # of the reflector about the elevation axis [kg m^2]


def make_run(
    case: str = "case3",
    *,
    contact: str | None = "contact",
    duration: float = 5.0,
    rate: float = 1000.0,
    seed: int = 1,
    free_base: bool = True,
    impacts_per_second: float = 120.0,
    strength: float = 1.0,
) -> xr.Dataset:
    """Return a made-up run; ``contact`` is "contact", "planar" or None for the ideal joint."""
    random = np.random.default_rng(seed)
    fine = np.linspace(0.0, duration, max(int(duration * 40_000), 1) + 1)
    torque = 4.0 * np.sin(2 * np.pi * fine)
    acceleration = torque / INERTIA
    names = {"contact": CONTACTS, "planar": ["elevation.radial"], None: []}[contact]
    count = int(impacts_per_second * duration) if names else 0
    onset = np.sort(random.uniform(0.0, duration, count))
    length = random.uniform(2e-4, 9e-4, count)
    peak = strength * random.lognormal(5.0, 1.0, count)
    which = random.integers(0, len(names), count) if names else np.empty(0, int)
    force = np.zeros((fine.size, max(len(names), 1)))
    direction = random.uniform(0.0, 2 * np.pi, count)
    radial = np.zeros((fine.size, 3))
    for k in range(count):
        span = (fine >= onset[k]) & (fine <= onset[k] + length[k])
        pulse = peak[k] * np.sin(np.pi * (fine[span] - onset[k]) / length[k])
        force[span, which[k]] += pulse
        name = names[which[k]]
        if ".radial" in name:
            radial[span, 0] += pulse * np.cos(direction[k])
            radial[span, 1] += pulse * np.sin(direction[k])
            acceleration[span] += pulse * 0.02 / INERTIA * random.choice([-1.0, 1.0])
        else:
            radial[span, 2] += pulse * (1.0 if name.endswith("+") else -1.0)
    step = fine[1] - fine[0] if fine.size > 1 else 0.0
    speed = np.concatenate([[0.0], np.cumsum((acceleration[1:] + acceleration[:-1]) / 2) * step])
    angle = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2) * step])
    every = np.arange(0.0, duration + 1e-12, 1.0 / rate)
    pick = np.unique(np.searchsorted(fine, np.concatenate([every, onset]) - 1e-9).clip(0, fine.size - 1))
    n = pick.size
    t = fine[pick]
    joints = ["azimuth", "elevation"]

    def two(values: np.ndarray) -> np.ndarray:
        return np.stack([0.3 * values, values], axis=1)

    has = bool(names)
    on_journal = radial[pick][:, None, :][:, : int(has)]
    kinetic = 0.5 * INERTIA * speed[pick] ** 2
    gross = np.cumsum(np.abs(torque * speed))[pick] * step
    lost = np.linspace(0.0, 0.05, n)[:, None] * np.ones(len(names))
    momentum = random.normal(size=(n, 3)).cumsum(axis=0) * 1e-15
    data: dict[str, tuple] = {
        "motion_angle": (("time", "joint"), two(angle[pick]), {"units": "rad"}),
        "motion_rate": (("time", "joint"), two(speed[pick]), {"units": "rad/s"}),
        "motion_acceleration": (("time", "joint"), two(acceleration[pick]), {"units": "rad/s**2"}),
        "joint_force": (
            ("time", "clearance_joint", "axis"),
            on_journal,
            {"units": "N"},
        ),
        "normal_force": (("time", "contact"), force[pick][:, : len(names)], {"units": "N"}),
        "drive_work": (("time", "drive"), two(kinetic + lost.sum(axis=1)), {"units": "J"}),
        "drive_gross_work": (("time", "drive"), two(gross), {"units": "J"}),
        "kinetic_energy": ("time", 1.3 * kinetic, {"units": "J"}),
        "contact_energy": ("time", 0.002 * force[pick].sum(axis=1), {"units": "J"}),
        "spring_energy": ("time", np.zeros(n), {"units": "J"}),
        "gravity_energy": ("time", np.zeros(n), {"units": "J"}),
        "dissipation_normal": (("time", "contact"), lost, {"units": "J"}),
        "dissipation_friction": (("time", "contact"), 0.4 * lost, {"units": "J"}),
        "energy_error": ("time", random.normal(size=n).cumsum() * 1e-10, {"units": "J"}),
        "linear_momentum": (("time", "axis"), momentum, {"units": "kg*m/s"}),
        "angular_momentum": (("time", "axis"), 3 * momentum, {"units": "kg*m**2/s"}),
        "momentum_scale": ("time", 1.0 + speed[pick], {"units": "kg*m/s"}),
        "angular_momentum_scale": ("time", 1.0 + speed[pick], {"units": "kg*m**2/s"}),
        "episode_contact": ("episode", which.astype(int)),
        "onset_time": ("episode", onset, {"units": "s"}),
        "peak_time": ("episode", onset + 0.5 * length, {"units": "s"}),
        "peak_force": ("episode", peak, {"units": "N"}),
    }
    if free_base:
        data["base_position"] = (("time", "axis"), np.zeros((n, 3)), {"units": "m"})
    return xr.Dataset(
        data,
        coords={
            "time": ("time", t, {"units": "s"}),
            "axis": ["x", "y", "z"],
            "joint": joints,
            "clearance_joint": ["elevation"] if has else np.empty(0, dtype="U9"),
            "contact": names if has else np.empty(0, dtype="U9"),
            "contact_joint": ("contact", np.array(["elevation" for _ in names], dtype="U9")),
            "contact_kind": (
                "contact",
                np.array([name.partition(".")[2].rstrip("+-") for name in names], dtype="U9"),
            ),
            "contact_end": (
                "contact",
                np.array([name.lstrip("abcdefghijklmnopqrstuvwxyz.") for name in names], "U9"),
            ),
            "drive": ["azimuth", "elevation"],
        },
        attrs={
            "case": case,
            "outcome": "COMPLETED",
            "scenario": json.dumps({"clearance": {"elevation": {"model": contact or "ideal"}}}),
        },
    )


def lines_of(axes) -> dict:
    """Return the lines of a panel by their labels."""
    return {line.get_label(): line for line in axes.lines}


def title_of(axes) -> str:
    """Return the title of a panel without its letter."""
    return axes.get_title("left").rpartition("$ ")[2]


def panels_of(figure) -> dict:
    """Return panels by their titles."""
    return {title_of(axes): axes for axes in figure.axes}


def note_of(figure) -> str:
    """Return the notes below the panels, in one line."""
    return " ".join(figure.get_supxlabel().split())


def factor_of(label: str, unit: str) -> float:
    """Return the factor of values in SI, from the prefix that an axis names."""
    text = label[label.rindex("[") + 1 : label.rindex("]")]
    return 1.0 / {"": 1.0, "m": 1e-3, "µ": 1e-6, "n": 1e-9, "k": 1e3}[text.removesuffix(unit)]


def check_texts(figure) -> None:
    """Assert that no two texts of a figure overlap, and that none is cut off at its edge."""
    FigureCanvasAgg(figure)
    figure.draw_without_rendering()  # places everything; no pixel is asked for
    renderer = figure.canvas.get_renderer()
    boxes = []
    for axes in figure.axes:
        texts = [
            axes.title,
            axes._left_title,
            axes._right_title,
            axes.xaxis.label,
            axes.yaxis.label,
            *axes.texts,
        ]
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            ticks = [*axis.get_major_ticks(), *axis.get_minor_ticks()]
            ticks = [tick for tick in ticks if low <= tick.get_loc() <= high]
            texts.append(axis.get_offset_text())
            texts += [tick.label1 for tick in ticks if tick.label1.get_visible()]
        boxes += [text for text in texts if text.get_text()]
    for legend in figure.legends:
        boxes += legend.get_texts()
    boxes += [text for text in (figure._supxlabel, figure._supylabel) if text is not None]
    extents = [(text.get_text(), text.get_window_extent(renderer)) for text in boxes]
    page = figure.bbox.padded(1.0)
    for text, box in extents:
        assert page.x0 <= box.x0 and box.x1 <= page.x1 and page.y0 <= box.y0 and box.y1 <= page.y1, text
    for (one, a), (other, b) in itertools.combinations(extents, 2):
        across = min(a.x1, b.x1) - max(a.x0, b.x0)
        along = min(a.y1, b.y1) - max(a.y0, b.y0)
        assert across <= 0.5 or along <= 0.5, f"{one!r} overlaps {other!r}"


@pytest.fixture(scope="session")
def readable() -> Callable:
    """Asserts that all texts of a figure can be read."""
    return check_texts


@pytest.fixture(scope="session")
def real_runs() -> dict:
    """Short runs of shipped models by case: ideal, planar, in space; ball joints are "floating"."""
    runs = {}
    for model, case, duration in (
        ("bai2020", "case1", 0.12),
        ("bai2020", "case2-planar", 0.12),
        ("bai2020", "case3", 0.08),
        ("spherical_pendulum", "floating", 0.02),
    ):
        changes = [f"duration={duration}"]
        if case in ("case2-planar", "case3"):
            changes.append("clearance.elevation.geometry=closed-form")
        scenario = load_scenario(model, case=case, overrides=changes)
        runs[case] = simulate(scenario).data.assign_attrs(scenario=scenario.model_dump_json())
    return runs


@pytest.fixture(scope="session")
def made_run() -> Callable[..., xr.Dataset]:
    """The maker of made-up runs."""
    return make_run
