"""What docs/architecture.md says it takes to add something is what it takes: done in a copy of the package.

A thing of a known kind is one file and one line. Each is run as a user meets it, without the compiler, which
needs none of what it would have to compile anew.
"""

import csv
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import antenna_pin
from antenna_pin import load_scenario, simulate

ROOT = Path(antenna_pin.__file__).parent


@pytest.fixture
def copy(tmp_path):
    """A copy of the package beside the shipped models, which is found before the installed one."""
    shutil.copytree(ROOT, tmp_path / "antenna_pin", ignore=shutil.ignore_patterns("*.nb[ic]"))
    (tmp_path / "models").symlink_to(ROOT.parent / "models")
    return tmp_path


def insert(copy, file, before, text):
    """Insert a line before the first one that begins with a text."""
    path = copy / "antenna_pin" / file
    lines = path.read_text(encoding="utf-8").splitlines()
    lines.insert(next(k for k, one in enumerate(lines) if one.strip().startswith(before)), text)
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")


def add(copy, file, text, registry, imported="", before="", entry=""):
    """Write a new file, and an entry before a line of a registry, with its import."""
    path = copy / "antenna_pin" / file
    assert not path.exists()
    path.write_text(text, encoding="utf-8")
    insert(copy, registry, before, entry)
    if imported:
        insert(copy, registry, "from antenna_pin", imported)


def run(copy, *words, code=None):
    """Run the command line, or some code, of the copy."""
    environment = os.environ | {"PYTHONPATH": str(copy), "NUMBA_DISABLE_JIT": "1", "COLUMNS": "200"}
    command = (
        [sys.executable, "-c", code] if code is not None else [sys.executable, "-m", "antenna_pin.apps.cli"]
    )
    done = subprocess.run(
        [*command, *words], cwd=copy, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


#: Of one process, for each start imports everything anew: words of commands, or code. Printed as JSON.
CALLS = """
import contextlib, io, json, sys
import antenna_pin.apps.cli as cli
said = []
for call in json.loads(sys.argv[1]):
    with contextlib.redirect_stdout(io.StringIO()) as stream:
        if isinstance(call, str):
            exec(call, {})
        else:
            sys.argv = ["antenna-pin", *call]
            try:
                cli.main()
            except SystemExit as ended:
                if ended.code:
                    sys.exit(f"{call}: exit code {ended.code}")
    said.append(stream.getvalue())
print(json.dumps(said))
"""


def run_all(copy, *calls):
    """Run commands and codes of the copy one after the other, and return what each prints."""
    return json.loads(run(copy, json.dumps(calls), code=CALLS).splitlines()[-1])


def swing(copy, spring):
    """Write the scenario of a bar on a hinge without play, against a spring, let go at half a radian."""
    (copy / "swing.toml").write_text(
        f"""format = 1
title = "a bar on a spring"
duration = "0.4 s"
[mechanism]
urdf = "{ROOT.parent / "models/pendulum/pendulum.urdf"}"
base = "fixed"
[springs.hinge]
{spring}
[initial.joints.hinge]
angle = "0.5 rad"
[integrator]
rtol = 1e-9
""",
        encoding="utf-8",
    )


# --- an element ---

CUBIC = '''
"""A spring whose torque grows with the third power of the angle."""

from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.base.readable import readable
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.element import Element


@dataclass(frozen=True, slots=True, kw_only=True)
class CubicSpring(Element):
    """A spring without a linear part, tau = -k phi^3.

    Attributes:
        cubic: k [N*m/rad^3].
    """

    kernels: ClassVar[str] = __name__
    senses: ClassVar[bool] = True

    cubic: float = parameter("N*m/rad**3", sliding="N/m**3", rule="positive")

    def words(self, slides):
        return f"cubic {readable(self.cubic, self.unit('cubic', slides))}"


@inlined
def effort(spring, t, angle, rate):
    return -spring.cubic * angle**3


@inlined
def stored(spring, angle):
    return 0.25 * spring.cubic * angle**4
'''


@pytest.mark.slow
def test_a_second_kind_in_springs_is_an_element_of_its_own(copy):
    """Run, told, drawn and kept: the energy it stores is in the ledger, or that would not close."""
    add(
        copy,
        "elements/cubic.py",
        CUBIC,
        "elements/registry.py",
        before='"between-points":',
        entry='"cubic": "cubic.CubicSpring",',
    )
    swing(copy, 'kind = "cubic"\ncubic = "40 N*m/rad**3"')
    run(copy, "run", "swing.toml", "--out", "swing.nc", "--quiet")
    run(copy, "report", "swing.nc", "--out", "swing.html", "--no-figures", "--no-recordings")
    assert "cubic 40" in (copy / "swing.html").read_text(encoding="utf-8")
    told = run(
        copy,
        code="import json, antenna_pin.trajectory as t; d = t.Trajectory.load('swing.nc').data; "
        "print(json.dumps([d.motion_angle.values[:, 0].tolist(), d.spring_energy.values.tolist(),"
        " d.energy_error.values.tolist()]))",
    )
    angle, energy, error = map(np.array, json.loads(told))
    assert np.ptp(angle) > 0.1
    assert energy == pytest.approx(10.0 * angle**4, rel=1e-12)  # the recorder's own formula is the kernel's
    assert np.abs(error).max() < 1e-7 * energy[0]  # rtol over some ten steps


# --- a controller ---

HOLDER = '''
"""A controller that pushes back, by what it measures."""

import dataclasses
from dataclasses import dataclass

from antenna_pin.base.parameters import check, parameter
from antenna_pin.elements.control.controller import SampledController
from antenna_pin.elements.control.measurement import Measure
from antenna_pin.elements.control.pid import Course


@dataclass(frozen=True, kw_only=True)
class Holder(SampledController):
    """u = k (r - phi).

    Attributes:
        acts_on: A drive.
        measures: What it measures.
        gain: k [-].
        reference: r.
    """

    acts_on: str
    measures: str = ""
    gain: float = parameter(rule="positive")
    reference: float | Course = 0.0

    def __post_init__(self):
        check(self)

    @property
    def measured(self):
        return (Measure.read(self, "measures", self.measures),)

    def placed(self, joints, axes):
        return dataclasses.replace(self, measures=f"angle {joints[self.acts_on]}")

    def update(self, now):
        wanted = self.reference(now.time)[0] if callable(self.reference) else self.reference
        return {self.acts_on: self.gain * (wanted - self.measured[0](now))}
'''


def test_a_controller_is_a_file_and_a_line(copy):
    """Its table follows from its class; its reference is in the unit of what it measures, or followed."""
    add(
        copy,
        "elements/control/holder.py",
        HOLDER,
        "elements/control/registry.py",
        before='"pid":',
        entry='"holder": "holder.Holder",',
    )
    swing(copy, 'stiffness = "10 N*m/rad"')
    with (copy / "swing.toml").open("a", encoding="utf-8") as file:
        file.write(
            "[drives.motor]\nkind = 'constant'\njoint = 'hinge'\nvalue = 0.0\n[controllers.hold]\n"
            "kind = 'holder'\nacts_on = 'motor'\nperiod = '50 ms'\ngain = 3\nreference = '90 deg'\n"
        )
    followed = """
from antenna_pin import load_scenario
slow = {
    "references.slow": {"kind": "sine", "amplitude": 1.0, "frequency": 1.0},
    "controllers.hold.follows": "slow",
}
free = load_scenario("swing.toml", overrides=slow | {"controllers.hold.reference": 0.0})
print(free.controllers["hold"].follows)
try:
    load_scenario("swing.toml", overrides=slow)
except ValueError as error:
    print(error)
"""
    _, told, chosen = run_all(
        copy,
        ("run", "swing.toml", "--out", "swing.nc", "--quiet"),
        "import json, antenna_pin.trajectory as t; d = t.Trajectory.load('swing.nc').data\n"
        "print(json.dumps([d.time.values.tolist(), d.motion_angle.values[:, 0].tolist(),"
        " d.drive_torque.values[:, 0].tolist()]))",
        followed,
    )
    time, angle, torque = map(np.array, json.loads(told))
    at = int(np.argmin(np.abs(time - 0.1)))
    assert time[at] == pytest.approx(0.1, abs=1e-12)
    # Held from a sampling time on.
    assert torque[at + 1] == pytest.approx(3.0 * (np.pi / 2.0 - angle[at]), rel=1e-12)
    slow, refused = chosen.splitlines()
    assert slow == "slow" and "reference must be left out with follows, which gives the reference" in refused


# --- a law ---

STAIRS = '''
"""Damping of a kind of one's own: a multiple of the elastic force."""

from dataclasses import dataclass

from antenna_pin.contact.hysteresis import HysteresisDamping


@dataclass(frozen=True, slots=True, kw_only=True)
class Halved(HysteresisDamping):
    """chi = (1 - c_r) / 2."""

    @property
    def hysteresis(self):
        return 0.5 * (1.0 - self.restitution)
'''


ROOT_FRICTION = '''
"""Friction that grows with the root of the slip speed."""

import math
from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import packed
from antenna_pin.compiled.decorators import inlined
from antenna_pin.contact.friction import CompiledFrictionLaw


@inlined
def root_ratio(law: "RootFriction", speed: float, force: float) -> float:
    return law.scale / math.sqrt(speed + law.least)


@dataclass(frozen=True, slots=True, kw_only=True)
class RootFriction(CompiledFrictionLaw):
    """mu = f sqrt(v / v_1).

    Attributes:
        level: f, the coefficient at v_1 [-].
        speed: v_1 [m/s].
    """

    kernel = staticmethod(root_ratio)
    unpacked: ClassVar[tuple[str, ...]] = ("level", "speed")

    level: float = parameter(rule="from 0 to 1")
    speed: float = parameter("m/s", rule="positive")
    least: float = parameter("m/s", rule="positive", default=1e-12)

    @packed
    def scale(self) -> float:
        return self.level / math.sqrt(self.speed)


'''

LINE = '''
"""A line that is stiffer beyond a depth."""

from dataclasses import dataclass

from antenna_pin.base.parameters import parameter
from antenna_pin.compiled.decorators import inlined
from antenna_pin.contact.normal import ElasticLaw


@inlined
def kinked_force(law: "Kinked", depth: float) -> float:
    return law.stiffness * (depth + max(depth - law.knee, 0.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Kinked(ElasticLaw):
    """f = K [d + max(d - d_k, 0)].

    Attributes:
        stiffness: K [N/m].
        knee: d_k [m].
    """

    kernel = staticmethod(kinked_force)

    stiffness: float = parameter("N/m", rule="positive")
    knee: float = parameter("m", rule="positive")
'''


def test_laws_are_a_file_and_a_line_each(copy):
    """Kernel, record, parameters, table and commands follow from the class; its energy is integrated.

    What damping delivers follows from chi alone: chi (1 + c) = ln[(1 + chi) / (1 - chi c)].
    """
    for name, text, before, entry in (
        ("halved", STAIRS, 'Alias("kelvin-voigt"', 'Alias("halved", "HalvedContact", "halved.Halved"),'),
        ("root_friction", ROOT_FRICTION, '"coulomb":', '"root": "root_friction.RootFriction",'),
        ("kinked", LINE, '"hertz-line":', '"kinked": "kinked.Kinked",'),
    ):
        add(copy, f"contact/{name}.py", text, "contact/registry.py", before=before, entry=entry)
    code = """
import json, antenna_pin.trajectory as t
from antenna_pin.contact import FRICTION_LAWS, make_normal_law
halved = make_normal_law("hertz", {"stiffness": 1e9, "restitution": 0.5}, "halved")
law = make_normal_law("kinked", {"stiffness": 1e6, "knee": 1e-5, "restitution": 0.5}, "flores")
root = FRICTION_LAWS["root"](level=0.2, speed=0.25)
v = t.Trajectory.load("halved.nc").data.v.values[[0, -1]].tolist()
print(json.dumps([halved.dissipation.hysteresis, v, law.elastic_force(3e-5), law.elastic_energy(3e-5),
    law.force(3e-5, 0.1, 0.1), root.coefficient(0.01)]))
"""
    # One impact: they touch after 1 ms at 0.1 m/s.
    pair = ("run", "impact_pair", "--duration", "2.5 ms", "--geometry", "closed-form", "--quiet")
    damped = "{law='hertz', dissipation='halved', stiffness='1e9 N/m**1.5', restitution=0.5}"
    stiff = "{law='kinked', dissipation='flores', restitution=0.9, stiffness='1e9 N/m', knee='1 mm'}"
    rough = "clearance.bore.friction={law='root', level=0.2, speed='0.25 m/s'}"
    *_, said = run_all(
        copy,
        (*pair, "--set", f"clearance.bore.normal={damped}", "--out", "halved.nc"),
        (*pair, "--set", f"clearance.bore.normal={stiff}", "--set", rough, "--out", "kinked.nc"),
        code,
    )
    chi, (before, after), force, energy, whole, coefficient = json.loads(said)
    assert chi == 0.25
    moving = int(np.argmax(np.abs(before)))
    c = -after[moving] / before[moving]
    # The run's tolerance 1e-10 over one impact of some tens of steps.
    assert chi * (1.0 + c) == pytest.approx(np.log((1.0 + chi) / (1.0 - chi * c)), rel=1e-7)
    assert force == pytest.approx(50.0, rel=1e-12) and whole == pytest.approx(force * 2.6, rel=1e-12)
    assert energy == pytest.approx(1e6 * (4.5e-10 + 2e-10), rel=1e-3)  # by quadrature across the kink
    assert coefficient == pytest.approx(0.2 * 0.2, rel=1e-9)


# --- a figure, a variable of the result, an event ---

BASE_ENERGY = '''
"""Energy of the whole, drawn."""

from antenna_pin.show.plot._compared import pick
from antenna_pin.show.plot._kinds import RunFigure
from antenna_pin.show.plot.grammar import Axis, Panel, Sheet, figure


@figure()
def figure_twice(runs, *, width="page"):
    """Return twice the energy of all runs."""
    curves = pick(runs).curves(lambda run: run.values("twice_the_energy"))
    return Sheet([[Panel("", curves, Axis("energy", "J"))]], width, 60.0)


FIGURES = (RunFigure("twice", "Twice the energy", figure_twice, standard=False),)
'''


@pytest.mark.slow
def test_a_figure_of_a_variable_that_is_new_and_an_event_of_ones_own(copy):
    """The variable is a row of the schema and its value; the figure a file; the event a function."""
    add(
        copy,
        "show/plot/twice.py",
        BASE_ENERGY,
        "show/plot/catalogue.py",
        "from antenna_pin.show.plot import twice",
        before="*audit.FIGURES,",
        entry="*twice.FIGURES,",
    )
    insert(
        copy,
        "trajectory/schema.py",
        '"state: time configuration",',
        '    "audit: time", ("twice_the_energy", "J", "kinetic energy, twice"),',
    )
    insert(
        copy,
        "run/simulation/variables.py",
        '"kinetic_energy": audit["kinetic"],',
        '"twice_the_energy": 2.0 * audit["kinetic"],',
    )
    swing(copy, 'stiffness = "10 N*m/rad"')
    code = """
from antenna_pin import load_scenario, simulate
from antenna_pin.run.simulation import Event, Stop

fallen = Event(name="fallen", when=lambda moment: moment.angle("hinge") - 0.4, action=Stop())
run = simulate(load_scenario("swing.toml"), events=[fallen])
run.save("fall.nc")
data = run.data
assert (data.twice_the_energy == 2.0 * data.kinetic_energy).all()
assert data.twice_the_energy.units == "J"
print(run.outcome.name, float(data.motion_angle[-1, 0]))
"""
    outcome, angle = run(copy, code=code).split()
    assert outcome.startswith("STOPPED")
    assert float(angle) == pytest.approx(0.4, rel=1e-12)  # events are located to round-off in time
    assert run(copy, "plot", "fall.nc", "--out", ".", "--figure", "twice").split() == ["twice.png"]
    assert (copy / "twice.png").stat().st_size > 1000


# --- a quantity of a whole run ---


def test_a_quantity_is_one_line_and_stands_in_tables_files_and_studies(copy):
    """A reduction of a series is recorded, and shown wherever quantities of a run are."""
    insert(
        copy,
        "trajectory/quantities.py",
        '"summary: sliding_joint"',
        '    ("peak_rate", "rad/s", "largest size of its rate at a sample", peak("motion_rate")),',
    )
    swing(copy, 'stiffness = "10 N*m/rad"')
    code = """
from antenna_pin.run.simulation.variables import SIZES
from antenna_pin.studies.sweep.responses import ResponseSpec, evaluate
from antenna_pin.trajectory import Trajectory

run = Trajectory.load("swing.nc")
response = ResponseSpec(measure="peak_rate", of="hinge")
assert SIZES["peak_rate"] == "motion_rate"  # what sensitivities are of
print(evaluate("rate", response, "", run, None, 0), response.unit, response.meaning, sep="; ")
"""
    _, summary, _, shown, _, measured = run_all(
        copy,
        ("run", "swing.toml", "--out", "swing.nc", "--quiet"),
        ("info", "swing.nc", "--json"),
        ("info", "swing.nc", "--csv", "swing.csv"),
        ("info", "swing.nc", "--all"),
        ("report", "swing.nc", "--out", "swing.html", "--no-figures", "--no-recordings"),
        code,
    )
    largest = json.loads(summary)["motion"]["hinge"]["peak_rate"]
    assert largest > 0.0
    with (copy / "swing.csv").open(newline="", encoding="utf-8") as file:
        (row,) = csv.DictReader(file)
    assert float(row["hinge peak rate [rad/s]"]) == largest
    assert "peak rate [rad/s]" in shown and f"{largest:.6g}" in shown
    assert "peak rate" in (copy / "swing.html").read_text(encoding="utf-8")
    assert measured.strip() == f"{largest}; rad/s; largest size of its rate at a sample, hinge"


def test_a_quantity_of_contacts_is_one_line_and_needs_no_new_run(copy):
    simulate(load_scenario("impact_pair"), duration=2.5e-3).save(copy / "pair.nc")
    insert(
        copy,
        "trajectory/quantities.py",
        '("impulse", "N s", "all normal impulses"',
        '    ("longest_contact", "s", "longest contact", peak("duration")),',
    )
    code = (
        "from antenna_pin.studies.sweep.measures import MEASURES;"
        "from antenna_pin.trajectory import Trajectory;"
        "from antenna_pin.studies.sweep.responses import ResponseSpec;"
        "print(MEASURES['longest_contact'].find(Trajectory.load('pair.nc'),"
        " ResponseSpec(measure='longest_contact'), None))"
    )
    summary, shown, measured = run_all(
        copy, ("info", "pair.nc", "--json"), ("info", "pair.nc", "--all"), code
    )
    longest = max(one["longest_contact"] for one in json.loads(summary)["contacts"].values())
    assert 0.0 < longest < 2.5e-3 and float(measured) == longest
    assert "longest contact [s]" in shown


# --- a joint with play ---

RING = '''
"""A thin ring on a rod: play at one place, and nothing that holds it along or keeps it upright."""

from dataclasses import dataclass

from antenna_pin.joints.geometry import kernels
from antenna_pin.joints.geometry.coal_pairs import CoalPlanar
from antenna_pin.joints.geometry.dimension import Play, dimension
from antenna_pin.joints.geometry.look import length, radial_words
from antenna_pin.joints.geometry.planar import PlanarClearance
from antenna_pin.joints.geometry.round_kernels import ROUND
from antenna_pin.joints.geometry.shape import ContactPlace, RoundShape, flat


def words(size):
    ring = radial_words("ring", size["bearing_radius"], "rod", size["journal_radius"])
    return [ring, f"wire {length(size['wire'])} thick"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Ring(RoundShape):
    """A ring on a rod.

    Attributes:
        bearing_radius: Of the hoop [m].
        journal_radius: Of the rod [m].
        wire: Thickness of the hoop [m].
    """

    kind = "ring"
    planar = False
    motion = "turn"
    half_length = None
    look = PlanarClearance.look._replace(
        held="a ring on a rod, held by contact alone",
        dimensions=words,
        contacts=frozenset({"hoop"}),
        rows=("radial",),
    )
    plays = (Play("hoop_clearance", "bearing_radius", "journal_radius", "Between hoop and rod [m]."),)

    bearing_radius: float = dimension("bearing", key="hoop_radius")
    journal_radius: float = dimension("journal", key="rod_radius", below="bearing_radius")
    wire: float = dimension("bearing", below="bearing_radius", times=(0.25, "bearing_radius"), words="wire")

    @property
    def contact_places(self):
        return (ContactPlace("hoop"),)

    def candidates(self, axes):
        return flat(ROUND, (kernels.CIRCLE_IN_CIRCLE, self.bearing_radius, self.journal_radius, (0.0,) * 6))

    def coal(self, axes):
        return CoalPlanar(self.bearing_radius, self.journal_radius)
'''

RING_SCENARIO = """format = 1
title = "two bodies that meet in a ring"
duration = "2 ms"
[mechanism]
urdf = "{urdf}"
base = "free"
gravity = [0.0, 0.0, 0.0]
[clearance.bore]
model = "ring"
hoop_radius = "10 mm"
hoop_clearance = "0.1 mm"
[initial.joints.bore]
journal_velocity = ["0.1 m/s", "0 m/s", "0 m/s"]
[integrator]
rtol = 1e-8
"""

RING_READ = """
import json
from antenna_pin import load_scenario
from antenna_pin.errors import ScenarioError
from antenna_pin.trajectory import Trajectory

joint = load_scenario("ring.toml").clearance["bore"]
rod = load_scenario("ring.toml", overrides={"clearance.bore.rod_radius": "9.8 mm"}).clearance["bore"]
hot = load_scenario("ring.toml", overrides={"temperature": "120 degC"})
from antenna_pin.scenario.assemble import at_temperature, joint_play
grown = at_temperature(hot).clearance["bore"].sizes()["wire"] / joint.sizes()["wire"]
try:
    load_scenario("ring.toml", overrides={"clearance.bore.hoop_clearance": "11 mm"})
except ScenarioError as error:
    refused = str(error)
coal, plain = (Trajectory.load(name).data for name in ("coal.nc", "plain.nc"))
print(json.dumps({
    "assumed": joint.assumed, "rod": [rod.hoop_clearance, rod.radial_play], "grown": grown,
    "refused": refused, "contacts": coal.contact.values.tolist(),
    "apart": float(coal.attrs["gap_difference"]), "touching": int(coal.touching.max()),
    "momentum": coal.linear_momentum.values[[0, -1]].tolist(),
    "forces": [float(abs(one.joint_force).max()) for one in (coal, plain)],
}))
"""


@pytest.mark.slow
def test_a_kind_of_joint_with_play_is_run_drawn_recorded_and_told_of(copy):
    """One file of geometry with its line in the registry: nothing else knows of it."""
    add(
        copy,
        "joints/geometry/ring.py",
        RING,
        "joints/geometry/registry.py",
        before='"spherical":',
        entry='"ring": "ring.Ring",',
    )
    urdf = ROOT.parent / "models/impact_pair/pair.urdf"
    (copy / "ring.toml").write_text(RING_SCENARIO.format(urdf=urdf), encoding="utf-8")
    *_, info, told = run_all(
        copy,
        ("run", "ring.toml", "--out", "coal.nc", "--quiet"),
        ("run", "ring.toml", "--geometry", "closed-form", "--out", "plain.nc", "--quiet"),
        ("info", "ring.toml"),
        RING_READ,
    )
    assert "with play (ring)" in info
    seen = json.loads(told)
    assert seen["assumed"]["wire"] == 0.0025 and "hoop_clearance" not in seen["assumed"]
    assert seen["rod"] == [None, pytest.approx(2e-4, rel=1e-12)]  # the radius takes the clearance's place
    assert seen["grown"] == pytest.approx(1.0 + 100.0 * 11.7e-6, rel=1e-12)  # steel, of which it is assumed
    rule = "clearance.bore.hoop_clearance must make rod_radius positive and finite, got 0.011 m"
    assert rule in seen["refused"]
    assert seen["contacts"] == ["bore.hoop"] and seen["touching"] == 1
    assert seen["apart"] < 1e-15  # coal's distance of a point from a cylinder is a closed form
    before, after = seen["momentum"]
    assert after == pytest.approx(before, rel=1e-11, abs=1e-14)  # internal forces, round-off
    coal, plain = seen["forces"]
    assert coal == pytest.approx(plain, rel=1e-6) and coal > 1.0
    figures = ("--figure", "contact_forces", "--figure", "journal_orbit")
    assert len(run(copy, "plot", "coal.nc", "--out", "f", *figures).split()) == 2
    run(copy, "record", "coal.nc", "--view", "joint", "--out", "ring.html")
    run(copy, "report", "coal.nc", "--out", "report.html", "--no-figures", "--no-recordings")
    page = (copy / "report.html").read_text(encoding="utf-8")
    assert "a ring on a rod, held by contact alone" in page and "ring of radius 10" in page
    assert "wire 2.5" in page  # among its dimensions and the assumptions
