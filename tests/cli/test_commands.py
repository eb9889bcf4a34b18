"""The command line: what it prints, what it refuses in one line, and how it ends."""

import contextlib
import dataclasses
import json
import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
import xarray as xr

import antenna_pin.run.simulation
from antenna_pin import load_scenario
from antenna_pin.apps.cli import app
from antenna_pin.errors import InvalidParameterError, OutputError
from antenna_pin.scenario import list_scenarios
from antenna_pin.show.plot import CATALOGUE, check_one_mechanism
from antenna_pin.show.plot._kinds import (
    CLOSED,
    CONTROLLED,
    COUPLED,
    FLEXIBLE,
    FORCED,
    GEARED,
    LOOPED,
    PRESCRIBED,
    RANDOM,
    STOPPED,
    SWEPT,
    TRACED,
)
from antenna_pin.trajectory import Outcome, Trajectory

SHORT = ("--duration", "20 ms", "--geometry", "closed-form", "--no-progress")


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Two results in a folder: the ideal case and the one with clearance."""
    folder = tmp_path_factory.mktemp("results")
    for case in ("case1", "case3"):
        with contextlib.redirect_stdout(None), pytest.raises(SystemExit) as ended:
            app(["run", "bai2020", "--case", case, "--out", str(folder / f"{case}.nc"), "--quiet", *SHORT])
        assert not ended.value.code
    return folder


@pytest.fixture
def drawn_quickly(monkeypatch):
    """Files of figures hold the texts of their legends: rendering is tested elsewhere, and takes the time."""

    def as_file(figure, suffix):
        texts = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
        return " ".join(texts).encode()

    monkeypatch.setattr("antenna_pin.show.plot.files._as_file", as_file)


# --- the face ---


def test_help_names_every_command(cli):
    said = cli("--help")
    assert said.code == 0
    for command in ("list", "run", "info", "analyse", "impacts", "plot", "figures", "urdf"):
        assert f"\n  {command} " in said.out
    assert "--install-completion" in said.out


def test_version(cli):
    assert cli("--version").out.startswith("antenna-pin 0.")


def test_list_has_one_line_per_case(cli):
    said = cli("list")
    lines = said.out.splitlines()
    assert lines[0] == "bai2020: Dual-axis satellite antenna with a 3D revolute clearance joint"
    names = [
        one for scenario in list_scenarios() for one in (scenario.name, *(c.name for c in scenario.cases))
    ]
    assert [line.split()[0].rstrip(":") for line in lines] == names
    assert all(len(line.split()) > 1 for line in lines)


# What takes long to load, each tenths of a second.
HEAVY = {
    "coal",
    "dask",
    "h5py",
    "matplotlib",
    "networkx",
    "numba",
    "numba.np.linalg",  # Numba's compiler; kept kernels are called without
    "pandas",
    "pinocchio",
    "pint",
    "rich",
    "scipy.interpolate",
    "scipy.optimize",
    "scipy.signal",
    "scipy.spatial",
    "trimesh",
    "xarray",
    "yourdfpy",
    "antenna_pin.scenario.scenario",  # whose classes take as long to make as all that list does
    # Kinds that no scenario here has: all of them together take longer than what is done with a file.
    "antenna_pin.contact.pin_joint",
    "antenna_pin.elements.control.relay",
    "antenna_pin.elements.ball_bearing",
    "antenna_pin.elements.harness",
    "antenna_pin.elements.latch",
    "antenna_pin.elements.slews",
    "antenna_pin.scenario.controllers",
}
READING = {"h5py", "pandas", "rich", "xarray"}
BUILDING = {"antenna_pin.scenario.scenario", "coal", "pinocchio"}
COMPILED = {"numba"}
RUN = ["run", "bai2020", "--case", "case3", "--duration", "1 ms", "--out", "short.nc", "-q"]


@pytest.mark.parametrize(
    ("arguments", "loaded"),
    [
        (["--help"], set()),
        (["list"], set()),
        (["info", "case3.nc"], READING),
        (["impacts", "case3.nc"], READING),
        (["info", "bai2020"], BUILDING),
        (["info", "slider_crank"], BUILDING | COMPILED),
        (RUN, BUILDING | COMPILED | READING - {"rich"}),
    ],
    ids=["help", "list", "info", "impacts", "info of a scenario", "info of loops", "run"],
)
def test_a_command_waits_for_what_it_needs_only(results, arguments, loaded, but_for_work):
    code = (
        "import sys\n"
        "from antenna_pin.apps._entry import main\n"
        f"sys.argv[1:] = {arguments!r}\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        f"print(*sorted(one for one in {HEAVY - loaded!r} if sys.modules.get(one)), file=sys.stderr)\n"
    )
    command = [sys.executable, "-c", code]
    for _ in range(2):  # the first may compile a kernel
        done = subprocess.run(command, cwd=results, capture_output=True, text=True, check=False)
        if (done.returncode, but_for_work(done.stderr)) == (0, "\n"):
            return
    raise AssertionError(done.stderr)


@pytest.mark.parametrize("arguments", [["list"], ["contact", "list"], ["info", "--help"]])
@pytest.mark.parametrize(
    ("redirected", "code", "why"),
    [(">/dev/full", 2, "No space left on device"), (">&-", 2, "Bad file descriptor"), ("| true", 0, "")],
)
def test_a_standard_output_that_takes_nothing_is_named(arguments, redirected, code, why):
    """Of printed text alone: closed, its place is not taken by the next file that is opened."""
    command = f"set -o pipefail; {sys.executable} -m antenna_pin.apps.cli {' '.join(arguments)} {redirected}"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    said = f"antenna-pin: standard output cannot be written: {why}\n" if why else ""
    assert done.stderr == said
    assert done.returncode == code or (not code and done.returncode == 1)  # 1: nobody reads the pipe


# --- run ---


def test_run_saves_and_summarises(cli, tmp_path):
    said = cli("run", "bai2020", "--case", "case3", *SHORT)
    assert said.code == 0, said.err
    first, *between, last = said.out.splitlines()
    assert (
        first.endswith("steps") and ", case case3: completed, 20\N{NO-BREAK SPACE}ms simulated in " in first
    )
    assert [line.split()[0] for line in between if line[2] != " "] == ["elevation", "energy"]
    assert last == "saved bai2020-case3.nc; all numbers: antenna-pin info --all bai2020-case3.nc"
    saved = Trajectory.load(tmp_path / "bai2020-case3.nc")
    assert saved.outcome is Outcome.COMPLETED
    assert float(saved.data["time"][-1]) == pytest.approx(0.02, rel=1e-12)
    assert saved.scenario.clearance["elevation"].geometry == "closed-form"


def test_quiet_says_nothing(cli, tmp_path):
    said = cli("run", "bai2020", "--case", "case1", "--duration", "0.001", "--out", "one.nc", "-q")
    assert (said.code, said.out, said.err) == (0, "", "")
    assert (tmp_path / "one.nc").is_file()


def test_progress_bar_shows_time_speed_and_step(cli):
    said = cli("run", "bai2020", "--case", "case1", "--duration", "0.01", "--no-summary")
    assert (said.code, said.out) == (0, "saved bai2020-case1.nc\n")
    assert all(words in said.err for words in ("bai2020-case1", "0.01 of 0.01 s", "s/s", "step"))


def test_the_geometry_reaches_joints_of_any_name(cli, tmp_path):
    folder = load_scenario("impact_pair").folder
    for name in ("scenario.toml", "pair.urdf"):
        text = (folder / name).read_text(encoding="utf-8").replace('"bore"', '"bore.1"')
        text = text.replace("clearance.bore]", 'clearance."bore.1"]').replace(
            "joints.bore]", 'joints."bore.1"]'
        )
        (tmp_path / name).write_text(text, encoding="utf-8")
    said = cli(
        "run", "scenario.toml", "--duration", "1e-4", "--quiet", "--geometry", "closed-form", "--out", "a.nc"
    )
    assert said.code == 0, said.err
    assert Trajectory.load(tmp_path / "a.nc").scenario.clearance["bore.1"].geometry == "closed-form"


def test_settings_reach_the_scenario(cli, tmp_path):
    said = cli(
        *("run", "bai2020", "--case", "case3", "--duration", "0.001", "--quiet", "--geometry", "closed-form"),
        *("--set", "integrator.rtol=1e-7", "--set", "clearance.elevation.radial_clearance=0.1 mm"),
    )
    assert said.code == 0, said.err
    scenario = Trajectory.load(tmp_path / "bai2020-case3.nc").scenario
    assert scenario.integrator.rtol == 1e-7
    assert scenario.clearance["elevation"].radial_clearance == pytest.approx(1e-4)


@pytest.fixture
def no_work(monkeypatch):
    """Make any simulation a failure: refusals come before the work."""

    def simulate(*_arguments, **_options):
        pytest.fail("the run had begun")

    monkeypatch.setattr(antenna_pin.run.simulation, "simulate", simulate)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["bia2020"], "did you mean bai2020"),
        (["missing.toml"], "missing.toml"),
        (["bai2020", "--case", "case33"], "did you mean case3"),
        (["bai2020", "--set", "integrator.rtoll=1e-9"], "did you mean rtol"),
        (["bai2020", "--set", "integrator.rtol"], "integrator.rtol"),
        (["bai2020", "--set", "clearance.elevation.radial_clearance=0.2 N"], "radial_clearance"),
        (["bai2020", "--set", "clearance.elevation.normal.restitution=1.3"], "[0, 1]"),
        (["bai2020", "--duration", "2 m"], "duration"),
        (["bai2020", "--duration", "-1"], "duration"),
        (["bai2020", "--duration", "soon"], "duration"),
        (["bai2020", "--out", "nowhere/x.nc"], "nowhere"),
        (["bai2020", "--out", "result.txt"], "try result.nc"),
        (["bai2020", "--out", "."], "folder"),
        (["bai2020", "--out", ""], "folder"),
        (["bai2020", "--out", "/proc/x.nc"], "/proc"),
    ],
)
def test_run_refuses_in_one_line_before_any_work(cli, no_work, arguments, says, refused):
    assert says in refused(cli("run", *arguments))


def test_what_only_the_mechanism_can_refuse_is_one_line_too(cli, refused):
    """A joint that the URDF does not have; no bar is left on the screen."""
    assert "wrist" in refused(cli("run", "bai2020", "--set", "clearance.wrist.model=ideal"))


def test_a_result_that_cannot_be_written_is_one_line(cli, monkeypatch, refused):
    def save(self, path):
        raise OutputError(f"{path}: cannot be written: No space left on device")

    monkeypatch.setattr(Trajectory, "save", save)
    said = cli("run", "bai2020", "--case", "case1", "--duration", "0.001", "--quiet")
    assert "No space left" in refused(said)


def test_an_unreadable_file_is_one_line(cli, tmp_path, monkeypatch, refused):
    def load(_path, **_options):
        raise PermissionError(13, "Permission denied", "locked.nc")

    monkeypatch.setattr(Trajectory, "load", load)
    assert refused(cli("info", "locked.nc")) == "antenna-pin: locked.nc: Permission denied"


@pytest.mark.parametrize(
    "short",
    [
        MemoryError(),
        ImportError("libzmq.so.5: failed to map segment from shared object"),
        ImportError("libzmq.so.5: cannot open shared object file: Cannot allocate memory"),
    ],
)
def test_memory_that_has_run_out_is_one_line(cli, monkeypatch, short, refused):
    """For numbers, or for a loaded library; another library that does not load is a bug."""
    errors = iter([short, ImportError("no module of that name")])

    def load(_path, **_options):
        raise next(errors)

    monkeypatch.setattr(Trajectory, "load", load)
    assert refused(cli("info", "some.nc")).startswith("antenna-pin: out of memory; use a shorter run")
    with pytest.raises(ImportError):
        cli("info", "some.nc")


def test_a_run_that_ends_early_is_saved_and_says_why(cli, tmp_path, monkeypatch):
    whole = antenna_pin.run.simulation.simulate

    def simulate(*arguments, **options):
        done = whole(*arguments, **options)
        ended = dataclasses.replace(
            done, outcome=Outcome.STEP_TOO_SMALL, message="at t = 0.001 s: the step fell below its floor"
        )
        ended.save(options["out"])
        return ended

    monkeypatch.setattr(antenna_pin.run.simulation, "simulate", simulate)
    said = cli("run", "bai2020", "--case", "case1", "--duration", "0.001", "--quiet")
    assert said.code == 3
    assert said.out == ""
    line = said.err.strip()
    assert line.startswith("antenna-pin: bai2020-case1: at t = 0.001 s: the step fell below its floor")
    assert "bai2020-case1.nc" in line
    assert Trajectory.load(tmp_path / "bai2020-case1.nc").outcome is Outcome.STEP_TOO_SMALL


def test_an_interrupted_run_is_saved(cli, tmp_path, monkeypatch):
    """The signal comes in the middle of the run, as from Ctrl-C."""

    signals = iter([signal.SIGINT])

    def report(_now):
        for number in signals:
            signal.raise_signal(number)

    @contextlib.contextmanager
    def ctrl_c(_title, _shown):
        yield report

    monkeypatch.setattr("antenna_pin.apps.cli.run.progress_bar", ctrl_c)
    said = cli("run", "bai2020", "--case", "case1", "--duration", "1000 s", "--no-summary")
    assert said.code == 130
    assert "Traceback" not in said.err
    saved = Trajectory.load(tmp_path / "bai2020-case1.nc")
    assert saved.outcome is Outcome.INTERRUPTED
    assert 0.0 < float(saved.data["time"][-1]) < 1000.0


def test_ctrl_c_outside_a_run_is_no_traceback(cli, monkeypatch):
    def interrupted(*_arguments, **_options):
        raise KeyboardInterrupt

    monkeypatch.setattr("antenna_pin.scenario.load_scenario", interrupted)
    said = cli("run", "bai2020")
    assert (said.code, said.out, said.err) == (130, "", "antenna-pin: interrupted\n")


# --- info ---


def test_info_sets_results_side_by_side(cli, results):
    said = cli("info", "--all", results / "case1.nc", results / "case3.nc")
    assert said.code == 0
    header, *rows = [line for line in said.out.splitlines() if line.strip()][1:]
    assert header.split() == ["case1", "case3"]
    figures = {" ".join(row.split()[:-2]): row.split()[-2:] for row in rows}
    assert figures["outcome"] == ["COMPLETED", "COMPLETED"]
    assert figures["simulated time [s]"] == ["0.02", "0.02"]
    assert figures["elevation.radial+ peak force [N]"][0] == "-"  # the ideal joint has no contact
    assert float(figures["steps accepted"][0]) > 0


def test_info_as_json_is_one_object_a_line(cli, results):
    files = [results / "case1.nc", results / "case3.nc"]
    said = cli("info", *files, "--json")
    objects = [json.loads(line) for line in said.out.splitlines()]
    assert [entry["file"] for entry in objects] == [str(path) for path in files]
    for entry, path in zip(objects, files, strict=True):
        shares = entry.pop("share of time", {})
        assert set(shares) == ({"elevation"} if path.stem == "case3" else set())
        for joint in shares.values():
            assert sum(joint.values()) == pytest.approx(1.0, abs=1e-12)
        assert entry == {"file": str(path), **json.loads(json.dumps(Trajectory.load(path).summary()))}


def test_info_refuses_what_is_not_a_result(cli, tmp_path, refused):
    (tmp_path / "notes.nc").write_text("not a result")
    assert "notes.nc" in refused(cli("info", "notes.nc"))
    assert "no such file" in refused(cli("info", "missing.nc"))


def test_info_says_what_a_run_assumed(cli):
    """The line that ``run`` ends with stands in the result too."""
    panel = Path(__file__).parents[2] / "scripts" / "examples" / "panel" / "first.toml"
    ran = cli("run", panel, "--duration", "1 ms", "--out", "a.nc", "--no-progress")
    (line,) = [said.removeprefix("note: ") for said in ran.out.splitlines() if "assumed" in said]
    for options in ((), ("--all",)):
        assert f"a: {line}" in cli("info", *options, "a.nc").out.splitlines()


# --- plot ---


# What the antenna has none of.
OTHER_MODELS = (
    *(CLOSED, CONTROLLED, COUPLED, PRESCRIBED, FLEXIBLE, FORCED),
    *(GEARED, TRACED, STOPPED, SWEPT, RANDOM),
)


def test_plot_writes_the_figures_and_names_them(cli, results, tmp_path, drawn_quickly):
    said = cli(
        "plot", results / "case1.nc", results / "case3.nc", "--out", "new/figures", "--format", "png,svg"
    )
    assert said.code == 0, said.err
    left = ("spectrogram", "slide_position", "slide_rate", "slide_acceleration")
    drawn = {
        name: figure.standard and figure.of is not LOOPED and figure.needs not in OTHER_MODELS
        for name, figure in CATALOGUE.items()
    }
    names = [name for name, standard in drawn.items() if standard and name not in left]
    words = "spectrogram-elevation is not drawn: figure: runs must be at least one of 64 samples"
    assert words in said.err  # in 20 ms
    joints = {name: "azimuth" if name == "joint_motion" else "elevation" for name in names}
    stems = [f"{name}-{joints[name]}" if CATALOGUE[name].of else name for name in names]
    expected = [f"new/figures/{stem}.{suffix}" for stem in stems for suffix in ("png", "svg")]
    assert said.out.splitlines() == expected
    assert all((tmp_path / path).is_file() for path in expected)
    assert "case1 (ideal)" in (tmp_path / "new/figures/motion_angle-elevation.svg").read_text()


def test_plot_draws_a_figure_by_its_name(cli, results, tmp_path, drawn_quickly):
    said = cli("plot", results / "case3.nc", "--out", "two", "--figure", "joints_rate", "--figure", "energy")
    assert said.out.splitlines() == ["two/joints_rate.png", "two/energy.png"], said.err
    ideal = cli("plot", results / "case1.nc", "--out", "none", "--figure", "contact_forces")
    assert (ideal.out, ideal.code) == ("", 0)
    assert "contact_forces is not drawn: no run has contact in a joint" in ideal.err


def test_plot_tells_two_runs_of_one_case_apart_by_their_files(cli, results, tmp_path, drawn_quickly):
    (tmp_path / "again.nc").write_bytes((results / "case3.nc").read_bytes())
    cli("plot", results / "case3.nc", "again.nc", "--out", "figures", "--format", "svg", "--width", "column")
    assert "again" in (tmp_path / "figures/motion_angle-elevation.svg").read_text()


def test_results_of_different_mechanisms_are_not_compared():
    """A joint ideal in one and with play in the other is the same joint; with none in common they differ."""

    def run(**names):
        coords = {along: [name] for along, name in names.items()}
        return SimpleNamespace(data=xr.Dataset(coords={"time": [0.0, 1.0], **coords}))

    antenna, play, other = run(joint="hinge"), run(clearance_joint="hinge"), run(joint="wheel")
    check_one_mechanism([("a.nc", antenna), ("b.nc", play)])
    with pytest.raises(InvalidParameterError, match=r"a\.nc with joints hinge and c\.nc with joints wheel"):
        check_one_mechanism([("a.nc", antenna), ("c.nc", other)])


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--out", "figures", "--format", "pgn"], "did you mean png"),
        (["--out", "figures", "--format", ""], "png"),
        (["--out", "file"], "this is a file"),
        (["--out", "figures", "--joint", "elevatoin"], "did you mean elevation"),
        (["--out", "figures", "--figure", "motion_angel"], "did you mean motion_angle"),
    ],
)
def test_plot_refuses_in_one_line(cli, results, tmp_path, options, says, refused):
    (tmp_path / "file").write_text("")
    assert says in refused(cli("plot", results / "case1.nc", *options))
    assert not (tmp_path / "figures").exists()


# --- figures ---

FAST = ("--duration", "30 ms", "--geometry", "closed-form", "--no-progress", "--format", "svg")


def test_figures_of_a_paper_are_numbered_and_listed(cli, tmp_path, drawn_quickly):
    said = cli("figures", "bai2020", "--out", "paper", *FAST)
    assert said.code == 0, said.err
    names = [line.removeprefix("paper/") for line in said.out.splitlines()]
    assert [name[:8] for name in names[:-1]] == [f"figure{number:02d}" for number in range(7, 14)]
    assert names[-1] == "index.md"
    index = (tmp_path / "paper/index.md").read_text()
    assert "antenna-pin figures bai2020 --duration '30 ms' --geometry closed-form" in index
    # Each is judged, though 30 ms are too short for what the paper shows.
    assert index.count("**agrees**: ") + index.count("**differs**: ") == 7
    for name in names[:-1]:
        assert name in index and (tmp_path / "paper" / name).is_file()
    results = sorted(path.name for path in (tmp_path / "paper/runs").iterdir())
    assert results == [f"bai2020-{case}.nc" for case in ("case1", "case2-planar", "case3", "case4", "case5")]


def test_figures_of_a_closed_loop_are_made(cli, tmp_path, drawn_quickly):
    numbers = [word for number in range(5, 9) for word in ("--figure", number)]
    said = cli("figures", "chen2021", *numbers, "--out", "paper", *FAST)
    assert said.code == 0, said.err
    names = [line.removeprefix("paper/") for line in said.out.splitlines()]
    assert [name[:8] for name in names[:-1]] == [f"figure{number:02d}" for number in range(5, 9)]
    index = (tmp_path / "paper/index.md").read_text()
    assert "deviation of the platform from the ideal run: friction-005 up to" in index
    assert "force through s2 in the second half of the run: friction-005 " in index
    results = sorted(path.name for path in (tmp_path / "paper/runs").iterdir())
    cases = ("friction-005", "friction-010", "friction-015", "ideal")
    assert results == [f"chen2021-{case}.nc" for case in cases]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ("chen2021 --figure 17", "--figure must be one of 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, got 17"),
        ("pendulum --figure 1", "it repeats no paper"),
        ("chen2021 --figure 9 --case ideal", "left out with --case"),
        ("chen2021 --figure 9 --set clearance.s2.friction.law=glue", "friction"),
        ("chen2021 --figure 9 --points 3", "32"),
        ("bai2021", "did you mean bai2020"),
        ("bai2020 --case case9", "case9"),
        ("bai2020 --format pgn", "did you mean png"),
        ("bai2020 --out file", "this is a file"),
        ("bai2020 --runs file", "cannot make this folder"),
        ("bai2020 --duration 5kg", "duration"),
    ],
)
def test_figures_that_cannot_be_made_are_refused_before_any_run(cli, tmp_path, arguments, says, refused):
    (tmp_path / "file").write_text("")
    words = arguments.split()
    assert says in refused(cli("figures", *words, "--no-progress"))
    assert "--runs" in words or [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.slow
def test_figures_of_settled_motions_are_made_once(cli, tmp_path, drawn_quickly):
    """Of the parallel mechanism, two values of a diagram and 32 points of a map: a minute and a half."""
    arguments = ("--figure", "13", "--figure", "14", "--count", "2", "--points", "32", "--no-progress")
    said = cli("figures", "chen2021", *arguments, "--out", "paper", "--format", "svg")
    assert said.code == 0, said.err
    index = (tmp_path / "paper/index.md").read_text()
    assert "clearance 0.30 mm: " in index and "period 1 at 2 values: 0.02 to 0.9 mm" in index
    assert "| case |" not in index
    again = cli("figures", "chen2021", *arguments, "--out", "paper", "--format", "svg")
    assert again.err.count("using ") == 4 and "running" not in again.err


def test_figures_use_results_of_the_same_scenario_again(cli, tmp_path, drawn_quickly):
    arguments = ("figures", "bai2020", "--case", "case1", *FAST)
    assert "case1: running 0.03 s" in cli(*arguments, "--out", "first").err
    (tmp_path / "first/runs/bai2020-case1.nc").rename(tmp_path / "first/runs/mine.nc")
    (tmp_path / "first/runs/other.nc").write_text("no result")
    again = cli(*arguments, "--out", "second", "--runs", "first/runs")
    assert "case1: using first/runs/mine.nc" in again.err
    # Another duration is another scenario; no file is written over.
    longer = cli(*arguments, "--duration", "31 ms", "--out", "third", "--runs", "first/runs")
    assert "running 0.031 s" in longer.err
    assert sorted(path.name for path in (tmp_path / "first/runs").glob("*.nc")) == [
        "bai2020-case1.nc",
        "mine.nc",
        "other.nc",
    ]


def test_a_result_of_another_scenario_is_not_written_over(cli, tmp_path, drawn_quickly):
    cli("run", "bai2020", "--case", "case1", "--out", "bai2020-case1.nc", "--duration", "5 ms", "--quiet")
    before = (tmp_path / "bai2020-case1.nc").read_bytes()
    assert cli("figures", "bai2020", "--case", "case1", *FAST, "--runs", ".", "--out", "new").code == 0
    assert (tmp_path / "bai2020-case1.nc").read_bytes() == before
    assert (tmp_path / "bai2020-case1-2.nc").is_file()


def test_figures_of_an_own_scenario_are_the_standard_set(cli, tmp_path, drawn_quickly):
    from antenna_pin import models_path

    for name in ("pendulum.urdf", "scenario.toml"):
        source = models_path() / "pendulum" / name
        (tmp_path / "own").mkdir(exist_ok=True)
        (tmp_path / "own" / name).write_bytes(source.read_bytes())
    said = cli("figures", "own", *FAST, "--case", "ideal", "--case", "planar")
    assert said.code == 0, said.err
    names = {line.rpartition("/")[2] for line in said.out.splitlines()}
    of_joint = {f"{name}-hinge.svg" for name in ("motion_angle", "joint_load", "journal_orbit")}
    assert {"energy.svg", *of_joint} <= names
    assert "| planar |" in (tmp_path / "own-figures/index.md").read_text()


def test_interrupted_figures_keep_what_is_done(cli, tmp_path, monkeypatch, drawn_quickly):
    """Ctrl-C in the third run: the figures of the first two are there, and the index says what is missing."""
    from antenna_pin.run.simulation import simulate as run_it

    def simulate(scenario, **options):
        run = run_it(scenario, **options)
        return dataclasses.replace(run, outcome=Outcome.INTERRUPTED) if scenario.case == "planar" else run

    monkeypatch.setattr(antenna_pin.run.simulation, "simulate", simulate)
    said = cli("figures", "you2010", *FAST, "--out", "out")
    assert said.code == 130
    index = (tmp_path / "out/index.md").read_text()
    assert "Not run: ideal." in index
    assert (tmp_path / "out/runs/you2010-planar.nc").is_file()


# --- urdf ---


def test_urdf_writes_the_variant_of_the_case(cli, tmp_path):
    said = cli("urdf", "bai2020", "--case", "case3")
    assert said.out == "saved bai2020-case3.urdf\n", said.err
    text = (tmp_path / "bai2020-case3.urdf").read_text()
    assert 'type="floating"' in text
    cli("urdf", "bai2020", "--case", "case1", "--out", "ideal.urdf")
    assert 'type="floating"' not in (tmp_path / "ideal.urdf").read_text()


def test_urdf_can_be_loaded_from_where_it_is(cli, tmp_path):
    """Its meshes are found from the new place too."""
    import pinocchio
    import yourdfpy

    cli("urdf", "bai2020", "--case", "case3")
    path = str(tmp_path / "bai2020-case3.urdf")
    model = pinocchio.buildModelFromUrdf(path, pinocchio.JointModelFreeFlyer())
    assert model.nv == 6 + 1 + 6
    assert yourdfpy.URDF.load(path, load_meshes=True).scene.geometry


def test_urdf_copies_its_meshes_if_asked(cli, tmp_path, refused):
    said = cli("urdf", "bai2020", "--case", "case3", "--copy-meshes")
    assert said.out == "saved bai2020-case3.urdf\nsaved dish.obj\n", said.err
    assert 'filename="dish.obj"' in (tmp_path / "bai2020-case3.urdf").read_text()
    (tmp_path / "dish.obj").write_text("another")
    assert "dish.obj: differs from" in refused(cli("urdf", "bai2020", "--case", "case3", "--copy-meshes"))


def test_urdf_refuses_a_place_it_cannot_write_to(cli, refused):
    assert "nowhere" in refused(cli("urdf", "bai2020", "--out", "nowhere/x.urdf"))
