"""What a report says is what the analyses found, of any number and any kind of runs."""

import dataclasses
import json
import re

import numpy as np
import pytest

from antenna_pin import Outcome, Trajectory, load_scenario, simulate
from antenna_pin.analysis import (
    deviation,
    dominant_frequencies,
    error_components,
    impacts,
    load_statistics,
    pointing_error,
    pointing_indices,
    settling,
)
from antenna_pin.show.report import Report, report
from antenna_pin.show.report._runs import ReportedRun
from antenna_pin.show.report.results import warnings

SUPERSCRIPTS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
PREFIXES = {"G": 1e9, "M": 1e6, "k": 1e3, "m": 1e-3, "µ": 1e-6, "n": 1e-9}
PLAIN_UNITS = "m|m/s|s|N|N s|J|rad|rad/s|m/s²|rad/s²|Hz|%|1/s|N m|W|kg m/s|kg m²/s|".split("|")


def read(text: str, unit: str) -> float:
    """Return a printed number in SI units."""
    digits, _, own = text.replace("\N{MINUS SIGN}", "-").partition("\N{NO-BREAK SPACE}")
    unit = own or unit
    mantissa, _, power = digits.partition("×10")
    number = float(mantissa) * 10.0 ** int(power.translate(SUPERSCRIPTS) or 0)
    if unit == "%":
        return number / 100.0
    if unit in PLAIN_UNITS:
        return number
    assert unit[1:] in PLAIN_UNITS
    return number * PREFIXES[unit[0]]


@pytest.fixture(scope="module")
def both(ideal, play, shown):
    return shown(report([ideal, play], figures=False, recordings=False).html)


def test_key_results_are_those_of_the_analyses(both, ideal, play):
    rows = both.numbers
    motion = play.summary()["motion"]["elevation"]
    own = "joint-elevation"
    assert rows(own, "angle at the end")[1] == motion["angle"]
    assert rows(own, "rate at the end")[1] == motion["rate"]
    peaks = rows(own, "peak acceleration")
    assert peaks[1] == motion["peak_acceleration"]
    assert rows(own, "the same over the ideal joint's") == [1.0, peaks[1] / peaks[0]]
    still = ideal.summary()["motion"]["azimuth"]
    assert rows("joints", "joint azimuth: angle at the end")[0] == still["angle"]
    table, loads = impacts(play), load_statistics(play)
    assert rows(own, "impacts") == [None, table.sizes["impact"]]
    assert rows("key-results", "peak force in elevation") == [None, table["peak_force"].values.max()]
    assert rows("key-results", "blows") == [None, len(set(table["blow"].values))]
    assert rows("key-results", "energy lost in contacts")[1] == loads["joint_dissipated"].item()
    away = deviation(play, ideal)
    most = max(("azimuth angle", "elevation angle"), key=lambda name: away[name].maximum)
    assert rows("key-results", f"deviation of {most}") == [None, away[most].maximum]
    for name, column in (
        ("peak force", "peak_force"),
        ("peak depth", "peak_depth"),
        ("largest approach speed", "approach_speed"),
    ):
        assert rows(own, name) == [None, table[column].values.max()]
    for name, column in (
        ("impulse", "impulse"),
        ("energy lost", "dissipated"),
        ("share of the time in contact", "contact_share"),
    ):
        assert rows(own, name)[1] == pytest.approx(loads[f"joint_{column}"].item(), rel=1e-12, abs=0.0)
    moved = play.data["base_position"].values
    farthest = np.linalg.norm(moved - moved[0], axis=1).max()
    assert rows("base", "farthest from its start")[1] == pytest.approx(farthest, rel=1e-12, abs=0.0)
    # The vector part of the quaternion is sin of half the angle; it starts at the identity.
    turned = 2 * np.arcsin(np.linalg.norm(play.data["base_attitude"].values[:, :3], axis=1).max())
    assert rows("base", "largest turn from its start")[1] == pytest.approx(turned, rel=1e-9, abs=0.0)


def test_deviation_impacts_loads_settling_and_frequencies_are_those_of_the_analyses(both, ideal, play):
    found = deviation(play, ideal)
    for key in ("deviation", "deviation-rates", "deviation-base"):
        for name in both.rows(key):
            of = found[name]
            assert both.numbers(key, name) == [of.maximum, of.time_of_maximum, of.rms, of.end, None]
    table = impacts(play)
    assert both.numbers("impact-summary-elevation", "peak force, median") == [np.median(table["peak_force"])]
    assert both.numbers("impact-summary-elevation", "still touching at the end") == [
        np.count_nonzero(~table["ended"])
    ]
    when = both.tree.xpath("//figure[@id='table-largest-impacts-elevation-case3']//tbody/tr/td[6]")
    strongest = np.argsort(-table["peak_force"].values, kind="stable")[: len(when)]
    assert [float(cell.get("data-value")) for cell in when] == list(table["peak_time"].values[strongest])
    hardest = both.tree.xpath("//figure[@id='table-largest-impacts-elevation-case3']//tbody/tr/td[3]")
    order = np.sort(table["peak_force"].values)[::-1][: len(hardest)]
    assert [float(cell.get("data-value") or np.nan) for cell in hardest] == list(
        table["approach_speed"].values[np.argsort(-table["peak_force"].values)][: len(hardest)]
    )
    assert len(hardest) == min(8, len(order))
    every = both.tree.xpath("//figure[@id='table-impacts-elevation-case3']//tbody/tr")
    assert len(every) == table.sizes["impact"]
    loads = load_statistics(play)
    assert both.numbers("loads-elevation", "elevation: rms force") == [loads["joint_rms_force"].item()]
    assert both.numbers("loads-elevation", "elevation: 99 % of the time") == [
        loads["joint_force_percentile"].sel(percent=99.0).item()
    ]
    contact = "elevation.radial+"
    assert both.numbers("loads-contacts-elevation", f"{contact}: peak force") == [
        loads["peak_force"].sel(contact=contact).item()
    ]
    (settled,) = settling(play)
    assert both.numbers("settling-elevation", "elevation: lasting contact from") == [settled.time]
    acceleration = play.data["motion_acceleration"].sel(joint="elevation").values
    peaks = dominant_frequencies(play.data["time"].values, acceleration, 3)["frequency"].values
    shown = [
        both.numbers("frequencies", name)[1] for name in both.rows("frequencies") if "of elevation: " in name
    ]
    assert [f for f in shown if f is not None][: len(peaks)] == list(peaks)


def test_impacts_are_told_in_the_units_of_the_analysis(both, play):
    """Units stand in the head of a column, with a prefix that suits all its numbers."""
    table = impacts(play)
    hardest = np.argsort(-table["peak_force"].values, kind="stable")[:8]
    (shown,) = both.tree.xpath("//figure[@id='table-largest-impacts-elevation-case3']")
    heads = [" ".join(one.text_content().split()).partition(" [") for one in shown.xpath(".//thead//th")][1:]
    names = [
        *("onset", "duration", "approach_speed", "restitution", "peak_force"),
        *("peak_time", "peak_depth", "impulse", "dissipated"),
    ]
    for k, (name, (_, _, unit)) in enumerate(zip(names, heads, strict=True), 1):
        unit, own = unit.rstrip("]"), table[name].attrs["units"].replace("1", "")
        assert unit == own or (unit[:1] in PREFIXES and unit[1:] == own), name
        for cell, value in zip(shown.xpath(f".//tbody/tr/td[{k}]"), table[name].values[hardest], strict=True):
            if np.isfinite(value):
                assert read(cell.text_content(), unit) == pytest.approx(value, rel=5.01e-3, abs=0.0)


def test_the_three_strongest_frequencies_are_told(ideal, shown):
    """Of five sines in an acceleration, with their amplitudes; of a signal without any nothing stands out."""
    time = ideal.data["time"].values
    sines = {140.0: 5.0, 300.0: 4.0, 60.0: 3.0, 380.0: 2.0, 220.0: 1.0}
    values = np.zeros_like(ideal.data["motion_acceleration"].values)
    values[:, 0] = sum(size * np.sin(2.0 * np.pi * f * time) for f, size in sines.items())
    data = ideal.data.assign(motion_acceleration=(("time", "joint"), values))
    page = shown(report(dataclasses.replace(ideal, data=data), figures=False, recordings=False).html)
    joint = str(data["joint"].values[0])
    rows = {name: cells for name, cells in page.rows("frequencies").items() if f"of {joint}: " in name}
    assert [cells[0][1] for cells in rows.values()] == pytest.approx([140.0, 300.0, 60.0], abs=1.0)
    sizes = [float(cells[0][0].partition(", ")[2].split("\N{NO-BREAK SPACE}")[0]) for cells in rows.values()]
    assert sizes == pytest.approx([5.0, 4.0, 3.0], rel=0.02)


def test_pointing_indices_have_their_windows_said(both, ideal, play, shown):
    errors = pointing_error(play, ideal)
    time = errors["time"].values
    wanted = pointing_indices(
        time,
        error_components(errors),
        window=time[-1] / 10,
        drift_spacing=time[-1] / 4,
        periods=time[-1] / 2,
        resolution=100,
    )
    kinds = {"APE": "absolute", "MPE": "mean", "RPE": "relative", "PDE": "drift", "PRE": "reproducibility"}
    for kind, word in kinds.items():
        group = f"{kind}, {word} error"
        for name in ("half-cone", "cross", "up", "boresight"):
            value = wanted["extreme"].sel(index=kind, component=name).item()
            assert both.numbers("pointing", f"{group}: {name}, largest") == [value]
        level = wanted["level"].sel(interpretation="temporal", index=kind, component="half-cone").item()
        assert both.numbers("pointing", f"{group}: half-cone, 99.7 % of the time") == [level]
    assert "Windows of 10 ms; drift over 25 ms" in both.text("//section[@id='pointing']")
    other = shown(report([ideal, play], figures=False, recordings=False, window=0.02).html)
    assert "Windows of 20 ms" in other.text("//section[@id='pointing']")


def test_every_number_is_printed_as_it_is(both):
    """What a reader reads off, unit and all, is the number behind it to the digits shown: three or more."""
    seen = 0
    for table in both.tree.xpath("//figure[starts-with(@id, 'table-')]"):
        key = table.get("id").removeprefix("table-")
        if key == "frequencies" or key.startswith("largest-"):
            continue  # two numbers in a cell; units in the head
        for cells in both.rows(key).values():
            for text, value, unit in cells:
                if value is not None:
                    seen += 1
                    assert read(text, unit) == pytest.approx(value, rel=5.01e-3, abs=0.0)
    assert seen > 150


def test_conservation_is_that_of_the_runs(both, ideal, play):
    for row, key in (
        ("energy balance error, relative", "energy_error_relative"),
        ("linear momentum drift, relative", "linear_momentum_drift_relative"),
        ("angular momentum drift", "angular_momentum_drift"),
    ):
        kept = [json.loads(run.data.attrs["conservation"])[key] for run in (ideal, play)]
        assert both.numbers("conservation", row) == kept


def test_the_scenario_is_told_in_words(both):
    assert both.said("what-mechanism")["bodies"].endswith("in all")
    joints = both.said("what-joints")
    assert "carries shaft1 on body; turns about the axis (0, 0, 1)" in joints["azimuth"]
    assert "case1" in joints["elevation"] and "held by contact alone" in joints["elevation"]
    play = both.said("what-clearance")["elevation"]
    assert play.startswith("case3 radial clearance 0.2 mm: bore of radius 10 mm, journal of 9.8 mm")
    assert "axial clearance 0.2 mm at each flange: bearing 50 mm long, flanges 50.4 mm apart" in play
    laws = both.said("what-contact-and-friction")
    assert re.search(
        r"lankarani-nikravesh: stiffness [\d.]+\sGN/m¹·⁵, restitution 0.9", laws["elevation, contact"]
    )
    assert "Young's modulus 207 GPa" in laws["elevation, journal's material"]
    drives = both.said("what-drives-and-springs")
    assert drives["drive azimuth"] == "10\N{NO-BREAK SPACE}N m × sin(2π · 1 Hz · t)".replace(
        "\N{NO-BREAK SPACE}", " "
    )
    assert "relative tolerance 1×10⁻⁸" in both.said("what-computation")["integrator"]
    scenario = both.said("what-scenario")
    assert scenario["set over the file"] == "duration=0.1"
    assert scenario["pointing"].startswith("reflector looks along (1, 0, 0) in its own axes")


@pytest.mark.parametrize("count", [1, 2, 5])
def test_any_number_of_runs(count, ideal, play, shown):
    runs = [ideal, *[play] * (count - 1)] if count > 1 else [play]
    made = report(runs, figures=False, recordings=False)
    page = shown(made.html)
    heads = page.tree.xpath("//figure[@id='table-key-results']//thead//th")
    labels = [head.text_content() for head in heads][1:]
    assert len(labels) == count and len(set(labels)) == count
    assert all(len(cells) == count for cells in page.rows("key-results").values())
    assert len(page.tree.xpath("//p[contains(@class, 'status')]")) == count
    if count == 1:
        assert "No other run, without clearance" in page.text("//section[@id='deviation']")


def test_a_report_says_what_it_is_in_one_line():
    assert repr(Report("Play", (), "x" * 3_000_000)) == "<Report 'Play': 0 sections, 3.0 MB>"


def test_a_run_that_ended_early_is_flagged_on_top(ideal, play, shown):
    message = "a contact was pressed beyond maximum_depth"
    cut = dataclasses.replace(play, outcome=Outcome.TOO_DEEP, message=message)
    page = shown(report([ideal, ("cut", cut)], figures=False, recordings=False).html)
    (bad,) = page.tree.xpath("//p[contains(@class, 'bad')]")
    text = " ".join(bad.text_content().split())
    assert "cut too deep" in text and message in text and "of 0.1 s requested" in text
    # Above everything else.
    assert page.tree.xpath("//main/section")[0].get("id") == "outcome"


def test_two_samples_are_a_run():
    """Its first and its last: there is something between them, and no warning that there is not."""
    ends = simulate(load_scenario("pendulum", case="ideal", overrides={"output.rate": 1e3}), duration=1e-3)
    assert ends.data.sizes["time"] == 2
    assert not [text for text in warnings([ReportedRun("ends", ends)]) if "sample" in text]
    one = ReportedRun("one", dataclasses.replace(ends, data=ends.data.isel(time=[0])))
    assert warnings([one])[0] == "one: one sample only, so nothing is drawn or analysed over time."


def test_one_sample_gives_what_there_is(ideal, single, shown):
    page = shown(report([ideal, ("start", single)], figures=False).html)
    assert "start: one sample only" in page.text("//div[@class='warnings']")
    assert "single" not in page.text("//section[@id='figures']")
    assert "of two samples or more" in page.text("//section[@id='deviation']")
    assert page.numbers("key-results", "simulated time") == [ideal.data["time"].values[-1], 0.0]
    alone = shown(report(single).html)
    assert not alone.tree.xpath("//section[@id='figures']") and not alone.tree.xpath(
        "//section[@id='recordings']"
    )


def test_a_fixed_base_without_drives(fixed, shown):
    page = shown(report(fixed, figures=False).html)
    assert "fixed in the world" in page.said("what-mechanism")["base"]
    assert page.said("what-mechanism")["gravity"].startswith("(0, 0, \N{MINUS SIGN}9.8")
    assert page.numbers("conservation", "linear momentum drift") == [None]
    assert not page.tree.xpath("//section[@id='base']")
    assert page.tree.xpath("//figure[@class='recording']")


def test_a_system_built_in_python(from_python, shown):
    page = shown(report(from_python, figures=False).html)
    assert page.said("what-clearance")["hinge"].startswith("planar, bar in stand; bearing radius 10")
    assert "a system built in Python" in page.said("provenance")["repeat the runs"]
    assert not page.tree.xpath("//section[@id='what-scenario']")
    assert "pendulum" in page.text("//h1")


def test_what_must_be_kept_and_is_not_is_warned_of(play, shown):
    kept = json.loads(play.data.attrs["conservation"]) | {"energy_error_relative": 3e-4}
    data = play.data.assign_attrs(conservation=json.dumps(kept), gap_difference=2e-6)
    page = shown(report(dataclasses.replace(play, data=data), figures=False, recordings=False).html)
    warned = page.text("//div[@class='warnings']")
    assert "the energy balance is off by 0.0003 of its scale" in warned
    assert "differ by 2 µm in the gaps" in warned


def test_a_limit_that_a_run_has_passed_is_warned_of(ideal, shown):
    urdf = ideal.data.attrs["urdf"]
    assert "<limit" in urdf and "limits are not simulated" not in warned_of(ideal, shown)
    narrow = re.sub(r'lower="[^"]*" upper="[^"]*"', 'lower="-1e-6" upper="1e-6"', urdf)
    warned = warned_of(dataclasses.replace(ideal, data=ideal.data.assign_attrs(urdf=narrow)), shown)
    for joint in ideal.data["joint"].values:
        assert re.search(rf"joint '{joint}' passes its limit of .* limits are not simulated\.", warned)


def warned_of(run, shown):
    page = shown(report(run, figures=False, recordings=False).html)
    return page.text("//div[@class='warnings']")


def test_labels_tell_files_of_one_case_apart(play, tmp_path, shown):
    files = [play.save(tmp_path / name) for name in ("tight.nc", "loose.nc")]
    made = report(files, figures=False, recordings=False)
    page = shown(made.html)
    assert page.text("//p[contains(@class, 'status')]/strong").split() == ["tight", "loose"]
    assert f"antenna-pin report {files[0]} {files[1]} --out report.html" in page.text(
        "//section[@id='provenance']"
    )
    again = report([Trajectory.load(files[0])], figures=False, recordings=False)
    assert shown(again.html).text("//p[contains(@class, 'status')]/strong") == "case3"
