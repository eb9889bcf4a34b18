"""An exported FMU, run by FMPy: its outputs are those of the run with the same commands, bit for bit."""

import json
import zipfile
from pathlib import Path

import numpy as np
import pint
import pytest
from sessions import antenna

from antenna_pin import load_scenario
from antenna_pin.apps.fmu import export_fmu
from antenna_pin.apps.fmu.packed import Packed
from antenna_pin.apps.fmu.slave import powers_of
from antenna_pin.errors import AntennaPinError, FileFormatError, OutputError
from antenna_pin.run.session import start

fmpy = pytest.importorskip("fmpy")
fmi3 = pytest.importorskip("fmpy.fmi3")
pytest.importorskip("pythonfmu3")
FMICallException = pytest.importorskip("fmpy.fmi1").FMICallException

OUTPUTS = ("elevation.angle", "elevation.rate", "elevation.radial+.force", "joint_force[elevation].x")


@pytest.fixture(scope="module")
def scenario():
    return antenna()


@pytest.fixture(scope="module")
def unit(scenario, tmp_path_factory):
    """The antenna with clearance as an FMU, unpacked: its description, its folder and the file."""
    path = export_fmu(
        scenario,
        tmp_path_factory.mktemp("fmu") / "antenna.fmu",
        inputs=["elevation", "springs.hold.damping"],
        outputs=OUTPUTS,
        parameters=["springs.hold.stiffness"],
    )
    return fmpy.read_model_description(str(path), validate=True), fmpy.extract(str(path)), path


class Master:
    """One instance of an FMU, by the functions of FMI."""

    def __init__(self, unit, name="one"):
        self.said = []
        self.description, folder, _ = unit
        kind = self.description.coSimulation.modelIdentifier
        token = self.description.guid or self.description.instantiationToken
        self.slave = fmi3.FMU3Slave(
            guid=token, unzipDirectory=folder, modelIdentifier=kind, instanceName=name
        )
        self.slave.instantiate(loggingOn=True, logMessage=self._note)
        self.numbers = {one.name: one.valueReference for one in self.description.modelVariables}
        self.time = 0.0

    def _note(self, environment, status, category, message):
        self.said.append(message.decode() if isinstance(message, bytes) else str(message))

    def begin(self, **values):
        self.slave.enterInitializationMode(startTime=0.0)
        self.set(**values)
        self.slave.exitInitializationMode()

    def set(self, **values):
        for name, value in values.items():
            self.slave.setFloat64([self.numbers[name.replace("__", ".")]], [value])

    def step_to(self, t):
        result = self.slave.doStep(self.time, t - self.time)
        self.time = t
        return result

    def read(self):
        return [self.slave.getFloat64([self.numbers[name]])[0] for name in OUTPUTS]

    def end(self):
        self.slave.terminate()
        self.slave.freeInstance()


COMMANDS = [(0.0, 1.5), (0.002, 1.5), (0.0035, -2.0), (0.009, 0.25), (0.012, 0.25)]


def expected(scenario, commands=COMMANDS, **sets):
    session = start(scenario)
    found, torque = [], 0.5
    for (t, value), (end, _) in zip(commands, [*commands[1:], (0.015, 0.0)], strict=True):
        if value != torque:
            session.command["elevation"] = torque = value
        session.run_until(t + (end - t))  # as a master adds a step to its time
        found.append([session[name] for name in OUTPUTS])
    return found


def test_its_outputs_are_those_of_the_session_at_every_communication_point(scenario, unit):
    master, found = Master(unit), []
    master.begin()
    for (_, value), (end, _) in zip(COMMANDS, [*COMMANDS[1:], (0.015, 0.0)], strict=True):
        master.set(elevation=value)
        master.step_to(end)
        found.append(master.read())
    master.end()
    assert found == expected(scenario)
    assert master.said == []


def test_fmpy_runs_it_and_steps_of_no_command_leave_no_trace(scenario, unit):
    _, _, path = unit
    coarse, fine = (
        fmpy.simulate_fmu(
            str(path), stop_time=0.016, step_size=h, output_interval=0.004, start_values={"elevation": 1.5}
        )
        for h in (0.004, 0.0005)
    )
    session = start(scenario)
    session.command["elevation"] = 1.5
    session.run_until(coarse["time"][-1])
    for name in OUTPUTS:
        assert coarse[name][-1] == session[name]
    # A master's sums of steps are other times by their last digit.
    assert np.allclose(coarse["elevation.rate"], fine["elevation.rate"], rtol=1e-12, atol=0.0)


def test_parameters_reset_and_two_instances(scenario, unit):
    one, other = Master(unit, "one"), Master(unit, "other")
    one.begin(springs__hold__stiffness=40.0)
    other.begin()
    for t in (0.003, 0.007):
        one.step_to(t)
        other.step_to(t)
    stiff = start(scenario.with_overrides({"springs.hold.stiffness": 40.0}))
    plain = start(scenario)
    for t in (0.003, 0.003 + (0.007 - 0.003)):
        stiff.run_until(t)
        plain.run_until(t)
    assert one.read() == [stiff[name] for name in OUTPUTS]
    assert other.read() == [plain[name] for name in OUTPUTS] != one.read()
    one.slave.reset()
    one.time = 0.0
    one.begin()
    for t in (0.003, 0.007):
        one.step_to(t)
    assert one.read() == other.read()
    one.end()
    other.end()


def test_state_is_got_set_and_sent(unit):
    one, other = Master(unit, "one"), Master(unit, "other")
    one.begin()
    other.begin()
    one.set(elevation=2.0)
    one.step_to(0.005)
    state = one.slave.getFMUState()
    sent = one.slave.serializeFMUState(state)
    one.step_to(0.012)
    once = one.read()
    one.slave.setFMUState(state)
    one.time = 0.005
    one.step_to(0.012)
    assert one.read() == once
    other.slave.setFMUState(other.slave.deserializeFMUState(sent))
    other.time = 0.005
    other.step_to(0.012)
    assert other.read() == once
    one.end()
    other.end()


def test_what_goes_wrong_is_told_in_the_log(unit):
    master = Master(unit)
    master.begin()
    master.step_to(0.001)
    master.set(springs__hold__damping=-1.0)
    with pytest.raises(FMICallException):
        master.step_to(0.002)
    assert any("damping must be zero or more" in line for line in master.said)
    again = Master(unit)
    again.begin()
    again.step_to(0.001)
    with pytest.raises(FMICallException):
        again.slave.doStep(0.005, 0.001)
    assert any("currentCommunicationPoint must be 0.001 s" in line for line in again.said)


def test_the_position_of_a_motion_is_no_input(tmp_path):
    """It would jump from one step to the next; the line names the rate in its place."""
    moved = load_scenario("slider_crank")
    given = {"outputs": ["crank.angle"]}
    with pytest.raises(AntennaPinError, match=r"fmu: drives\.crank\.position .* use drives\.crank\.rate"):
        export_fmu(moved, tmp_path / "a.fmu", inputs=["drives.crank.position"], **given)
    assert export_fmu(moved, tmp_path / "b.fmu", inputs=["drives.crank.rate"], **given).exists()


def test_its_description(scenario, unit):
    description, _, path = unit
    assert description.fmiVersion == "3.0" and description.coSimulation.canGetAndSetFMUstate
    assert description.coSimulation.canHandleVariableCommunicationStepSize
    assert float(description.defaultExperiment.stopTime) == scenario.duration
    found = {one.name: one for one in description.modelVariables}
    torque = found["elevation"]
    assert (torque.causality, torque.unit, float(torque.start)) == ("input", "N m", 0.5)
    assert found["elevation.rate"].unit == "rad/s" and found["elevation.rate"].causality == "output"
    assert found["springs.hold.stiffness"].unit == "N m/rad"
    assert found["springs.hold.stiffness"].variability == "fixed"
    names = zipfile.ZipFile(path).namelist()
    assert any(name.endswith(".urdf") for name in names) and any(name.endswith(".obj") for name in names)
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(path)) == []


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"inputs": ["elevaton"]}, "did you mean elevation"),
        ({"outputs": ["elevation.angel"]}, "did you mean elevation.angle"),
        ({"outputs": []}, "outputs must be one name or more"),
        ({"outputs": ["elevation.angle", "elevation.angle"]}, "named once each"),
        (
            {"inputs": ["elevation", "drives.elevation.value"]},
            "one of each number; drives.elevation.value is",
        ),
        ({"parameters": ["format"]}, "the place of one number"),
        ({"parameters": ["springs.hold.stifness"]}, "the place of one number that the scenario has"),
        ({"out": "here.zip"}, r"must end in .fmu; try here.fmu"),
        ({"out": "nowhere/here.fmu"}, "nowhere"),
    ],
)
def test_what_cannot_be_exported_is_refused_in_one_line(scenario, tmp_path, monkeypatch, given, says):
    monkeypatch.chdir(tmp_path)
    with pytest.raises((AntennaPinError, OutputError), match=says) as refused:
        export_fmu(scenario, **{"out": "here.fmu", "outputs": ["elevation.angle"], **given})
    assert "\n" not in str(refused.value)
    assert not list(Path().iterdir())


@pytest.mark.parametrize(
    "change",
    [{"inputs": 1.0}, {"outputs": [1]}, {"scenario": None}, {"more": []}, {"parameters": None}],
    ids=str,
)
def test_a_pack_that_was_changed_is_refused_in_one_line(scenario, tmp_path, change):
    packed = Packed(scenario=scenario, inputs=(), outputs=("elevation.angle",), parameters=(), token="one")
    packed.write(tmp_path)
    assert Packed.read(tmp_path).outputs == packed.outputs
    (path,) = tmp_path.iterdir()
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    with pytest.raises(FileFormatError, match="must be as it was packed, got .*; export it again") as refused:
        Packed.read(tmp_path)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("unit_", "powers"),
    [
        ("N m/rad", {"kg": 1, "m": 2, "s": -2, "rad": -1}),
        ("rad/s^2", {"rad": 1, "s": -2}),
        ("Pa m^3 Hz", {"kg": 1, "m": 2, "s": -3}),
        ("H A/s", {"kg": 1, "m": 2, "s": -3, "A": -1}),
        ("ohm A", {"kg": 1, "m": 2, "s": -3, "A": -1}),
        ("1", None),
        ("m, rad or 1", None),
        ("N/m^1.5", None),
    ],
)
def test_units_as_powers(unit_, powers):
    assert powers_of(unit_) == powers


def test_units_by_name_have_the_powers_that_pint_gives_them():
    """A master converts by them: a power that is off makes a torque an energy without a word."""
    registry = pint.UnitRegistry()
    dimensions = {"kg": "[mass]", "m": "[length]", "s": "[time]", "A": "[current]", "K": "[temperature]"}
    for name in "N J W Pa Hz V H ohm kg m s A K rad".split():
        plain = registry.Quantity(1.0, name).to_base_units()
        powers = {one: plain.dimensionality.get(dimension, 0) for one, dimension in dimensions.items()}
        assert powers_of(name) == ({one: power for one, power in powers.items() if power} or {"rad": 1})
        assert powers_of(f"{name}^2/s^7") == powers_of(f"{name} {name}/(s^2 s^5)")
        assert plain.magnitude == 1.0 or name == "kg"  # a base unit of FMI; pint's is the gram
