"""Bad inputs: result files, damaged, edited or of somebody else."""

from __future__ import annotations

import functools
import json
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from bad_inputs.case import FILES, MECHANISM, Case
from fuzzing.made import SEAL
from fuzzing.results import put_variable, with_value, write_edited
from robust.trials import Content, flipped, write_files

from antenna_pin import Trajectory, load_scenario, simulate

Edit = Callable[[Any], Any]


@functools.cache
def result() -> bytes:
    """Return the file of a short run with contacts."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_files(folder, FILES)
        scenario = load_scenario(folder, overrides={"initial.joints.hinge.journal_velocity": [0.5, 0.0, 0.0]})
        return simulate(scenario).save(folder / "run.nc").read_bytes()


def write_result(path: Path) -> None:
    """Write a result that is sound."""
    path.write_bytes(result())


def _edited(edit: Edit) -> Callable[[Path], None]:
    """Return what writes a result that somebody has edited, who knows to leave no seal."""
    return lambda path: write_edited(result(), [edit], False, path)


def _attribute(name: str, value: Any) -> Edit:
    return lambda file: file.attrs.__setitem__(name, value)


def _without(name: str) -> Edit:
    return lambda file: file.attrs.__delitem__(name)


def _json(name: str, change: Callable[[Any], Any]) -> Edit:
    return lambda file: file.attrs.__setitem__(name, json.dumps(change(json.loads(file.attrs[name]))))


def _gone(name: str) -> Edit:
    return lambda file: file.__delitem__(name)


def _instead(put: Edit) -> Edit:
    """Return what puts something else into the place of the gaps."""
    return lambda file: (file.__delitem__("gap"), put(file))


def _values(name: str, change: Callable[[Any], Any], **more: Any) -> Edit:
    """Return what puts other values into a variable, which keeps its dimensions."""
    return lambda file: put_variable(file, name, change(file[name][()]), **more)


def _with(at: int, value: float) -> Callable[[Any], Any]:
    return lambda values: with_value(values, at, value)


def _no_contacts(file: Any) -> None:
    for name in [*file]:
        if "contact" in name and file[name].is_scale:
            _values(name, lambda values: values[:0])(file)
    for name in ("gap", "depth", "normal_force"):
        _values(name, lambda values: values[:, :0])(file)


def _with_key(name: str, *keys: str, value: Any) -> Edit:
    """Return what sets an entry within an attribute's JSON."""

    def change(content: Any) -> Any:
        table = content
        for key in keys[:-1]:
            table = table[key]
        table[keys[-1]] = value
        return content

    return _json(name, change)


_ELSEWHERE = h5py.ExternalLink("no.nc", "/gap")
_TEXT = {"dtype": h5py.string_dtype()}

_ATTRIBUTES = tuple(
    "case clearance_joints conservation counts drives end_time gap_difference mechanism outcome "
    "outcome_message samples scenario title urdf urdf_folder".split()
)
_VARIABLES = tuple(
    "contact contact_joint contact_kind clearance_joint drive axis configuration time q v a gap "
    "contact_force joint_torque motion_angle drive_work energy_error linear_momentum final_angle peak_force "
    "peak_depth episode_contact dissipation_damper base_position".split()
)
_HINGE = ("clearance_joints", "hinge")

_EDITS: Mapping[str, tuple[Edit, str]] = {
    "format an array": (_attribute("format", [1, 2]), "the format must be"),
    "format of numbers": (_attribute("format", 3), "the format must be"),
    "format of an older version": (_attribute("format", "antenna_pin trajectory 2"), "run the scenario"),
    "no format": (_without("format"), "the format must be"),
    "title a number": (_attribute("title", 3), "'title' that cannot be read"),
    "title an array": (_attribute("title", ["a", "b"]), "'title' that cannot be read"),
    "outcome unknown": (_attribute("outcome", "PERHAPS"), "'outcome' that cannot be read"),
    "counts a list": (_attribute("counts", "[]"), "'counts' that cannot be read"),
    "counts with more": (_attribute("counts", '{"laps": 3}'), "'counts' that cannot be read"),
    "scenario no JSON": (_attribute("scenario", "{"), "'scenario', which must be a table, as JSON"),
    "scenario empty": (_attribute("scenario", "{}"), "'scenario' that cannot be read"),
    "scenario nested without end": (_attribute("scenario", "[" * 50_000), "'scenario', which must be a"),
    "end no JSON": (_attribute("end", "{"), "'end' that cannot be read"),
    "end of another shape": (_attribute("end", '{"time": 0}'), "'end' that cannot be read"),
    "end time text": (_attribute("end_time", "soon"), "'end_time' that cannot be read"),
    "end time before the start": (_attribute("end_time", -1.0), "'end_time' that cannot be read"),
    "samples text": (_attribute("samples", "many"), "'samples' that cannot be read"),
    "gap difference text": (_attribute("gap_difference", "none"), "'gap_difference' that cannot be read"),
    "conservation no JSON": (_attribute("conservation", "{"), "'conservation' that cannot be read"),
    "conservation a list": (_attribute("conservation", "[]"), "'conservation' that cannot be read"),
    "conservation empty": (_attribute("conservation", "{}"), "'conservation' that cannot be read"),
    "conservation nested": (_attribute("conservation", "[" * 50_000), "'conservation' that cannot be read"),
    "conservation with text": (_with_key("conservation", "energy_error", value="x"), "energy_error"),
    "conservation with a table": (_with_key("conservation", "gross_work", value={}), "gross_work"),
    "mechanism without gravity": (_attribute("mechanism", '{"base": "free"}'), "gravity"),
    "mechanism with two of gravity": (_with_key("mechanism", "gravity", value=[0, 1]), "gravity"),
    "base unknown": (_with_key("mechanism", "base", value="loose"), "base"),
    "joints a list": (_attribute("clearance_joints", "[]"), "'clearance_joints' that cannot be read"),
    "no joints": (_attribute("clearance_joints", "{}"), "'clearance_joints'"),
    "joint a number": (_attribute("clearance_joints", '{"hinge": 3}'), "hinge"),
    "joint of another name": (_json("clearance_joints", lambda of: {"x": of["hinge"]}), "clearance_joint"),
    "placement of six": (_with_key(*_HINGE, "bearing_placement", value=[0] * 6), "bearing_placement"),
    "placement of text": (_with_key(*_HINGE, "journal_placement", value="here"), "journal_placement"),
    "placement nan": (_with_key(*_HINGE, "journal_placement", value=[float("nan")] * 7), "journal_placement"),
    "attitude of no length": (_with_key(*_HINGE, "bearing_placement", value=[0] * 7), "bearing_placement"),
    "dimension text": (_with_key(*_HINGE, "dimensions", "bearing_radius", value="x"), "bearing_radius"),
    "bearing on neither": (_with_key(*_HINGE, "bearing_on", value="both"), "bearing_on"),
    "law without parameters": (_with_key(*_HINGE, "friction_law", value={"law": "tanh"}), "parameters"),
    "drives a list": (_attribute("drives", "[]"), "'drives' that cannot be read"),
    "drive of another name": (_json("drives", lambda of: {"x": of["motor"]}), "drive"),
    "drive of no joint": (_with_key("drives", "motor", "joint", value=3), "joint"),
    "time text": (_values("time", lambda of: of.astype("S10")), "'time'"),
    "time nan": (_values("time", _with(1, float("nan"))), "got nan in 'time' at sample 1"),
    "time goes back": (_values("time", lambda of: of[::-1]), "which must be finite, no less than the one"),
    "one sample less": (_values("time", lambda of: of[:-1]), ""),
    "gaps in millimetres": (lambda file: file["gap"].attrs.__setitem__("units", "mm"), "'gap' in 'mm'"),
    "q nan": (_values("q", _with(3, float("nan"))), "must be finite"),
    "v infinite": (_values("v", _with(3, float("inf"))), "which must be finite"),
    "q of text": (_values("q", lambda of: of.astype("S10")), "'q'"),
    "q complex": (_values("q", lambda of: of.astype(complex)), "'q'"),
    "q of one number more": (_values("q", lambda of: np.hstack([of, of[:, :1]])), ""),
    "q with an axis more": (_values("q", lambda of: of[..., None]), ""),
    "forces of text": (_values("peak_force", lambda of: of.astype("S10")), "'peak_force'"),
    "axis of two": (_values("axis", lambda of: of[:2]), ""),
    "axis of others": (_values("axis", lambda of: of[::-1], **_TEXT), "'axis'"),
    "labels of numbers": (_values("contact", lambda of: np.arange(len(of))), "'contact' that are not text"),
    "labels twice": (_values("contact", lambda of: of[[0, 0, 2, 3]], **_TEXT), "that are there twice"),
    "labels no UTF-8": (_values("contact", lambda of: np.array([b"\xff"] * len(of))), ""),
    "a contact of no joint": (
        _values("contact_joint", lambda of: np.array([b"x"] * len(of), object), **_TEXT),
        "'x' in 'contact_joint'",
    ),
    "episodes of no contact": (_values("episode_contact", lambda of: of + 99), "'episode_contact'"),
    "episodes before the first": (_values("episode_contact", lambda of: of - 99), "'episode_contact'"),
    "episodes of half a contact": (_values("episode_contact", lambda of: of + 0.5), "'episode_contact'"),
    "zero contacts": (_no_contacts, ""),
    "a group for a variable": (_instead(lambda file: file.create_group("gap")), ""),
    "an empty variable": (_instead(lambda file: file.create_dataset("gap", data=h5py.Empty("f8"))), ""),
    "a link to nowhere": (_instead(lambda file: file.__setitem__("gap", h5py.SoftLink("/nowhere"))), ""),
    "a link to itself": (_instead(lambda file: file.__setitem__("gap", h5py.SoftLink("/gap"))), ""),
    "a link to another file": (_instead(lambda file: file.__setitem__("gap", _ELSEWHERE)), ""),
}


# What is found out only where bodies are drawn: to load a result builds no mechanism.
_DRAWN: Mapping[str, tuple[Edit, str]] = {
    "bearing on no link": (_with_key(*_HINGE, "bearing_body", value="nowhere"), "nowhere"),
    "URDF no XML": (_attribute("urdf", "<robot"), "'urdf' that cannot be read"),
    "URDF of another mechanism": (_attribute("urdf", MECHANISM.replace("hinge", "pivot")), ""),
    "URDF with a joint more": (_attribute("urdf", MECHANISM.replace('"revolute"', '"planar"')), ""),
    "URDF with other links": (_attribute("urdf", MECHANISM.replace('"bar"', '"rod"')), ""),
}


def _files() -> Iterator[tuple[str, Content, str]]:
    """Yield whole files that are none."""
    yield "empty file", b"", "must be a NetCDF file"
    yield "text", b"hello", "must be a NetCDF file"
    yield "zeros", bytes(5000), "must be a NetCDF file"
    yield "only a signature", b"\x89HDF\r\n\x1a\n", "must be a NetCDF file"
    yield "an older NetCDF", b"CDF\x01" + bytes(100), "must be a NetCDF file"
    yield "empty HDF5", lambda path: h5py.File(path, "w").close(), "the format must be"
    for share in (0.01, 0.3, 0.6, 0.9, 0.999):
        cut = _of_result(lambda whole, share=share: whole[: int(share * len(whole))])
        yield f"cut off at {100 * share:g} %", cut, "must be"
    yield "twice the file", _of_result(lambda whole: 2 * whole), "another checksum"
    yield "a seal too much", _of_result(lambda whole: whole + whole[-SEAL:]), "another checksum"
    yield "no seal", _of_result(lambda whole: whole[:-SEAL]), "another checksum"
    for share in np.linspace(0.02, 0.98, 12):
        flip = _of_result(lambda whole, share=share: flipped(whole, 8 * int(share * len(whole))))
        yield f"a bit flipped at {100 * share:.0f} %", flip, ""


def _of_result(change: Callable[[bytes], bytes]) -> Callable[[Path], Any]:
    return lambda path: path.write_bytes(change(result()))


def cases() -> Iterator[Case]:
    """Yield all of them."""
    edits: dict[str, tuple[Edit, str]] = {**_EDITS}
    for name in _ATTRIBUTES:
        edits[f"no attribute {name}"] = (_without(name), f"{name!r}")
        edits[f"attribute {name} an array"] = (_attribute(name, [1.0, 2.0]), f"{name!r}")
    for name in _VARIABLES:
        edits[f"no variable {name}"] = (_gone(name), f"{name}")
    for name, (edit, says) in edits.items():
        # To say what a result is, nobody reads its scenario.
        act = (lambda: Trajectory.load("run.nc")) if name.startswith("scenario") else ("info", "run.nc")
        yield Case("results", name, says, act, {"run.nc": _edited(edit)})
    for name, (edit, says) in _DRAWN.items():
        yield Case("results", name, says, ("record", "run.nc", "--out", "a.html"), {"run.nc": _edited(edit)})
    for name, content, says in _files():
        yield Case("results", name, says, ("info", "run.nc"), {"run.nc": content})
