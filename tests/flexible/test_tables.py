"""Modal data from text: CSV, printed tables, and what is refused, with its line."""

from __future__ import annotations

from pathlib import Path

import pytest

from antenna_pin import AntennaPinError, Scenario, build_system, load_scenario
from antenna_pin.base import capacity
from antenna_pin.errors import TooLargeError
from antenna_pin.mechanism.flexible.modal_files import BadModalTableError, read_modal_table

CSV = """# two modes
frequency,damping_ratio,tx,ty,tz,rx,ry,rz
3,0.005,2.2,0,0,0,0,-1.9

18.8,0.01,1.2,0,0.5,0,0,-0.3
"""
# As NASTRAN prints it: spaced headings, page headings in between, short exponents.
PRINT = """1    WING                              NOVEMBER  22, 2026  MSC.NASTRAN 11/22/24   PAGE    12
0
                                              R E A L   E I G E N V A L U E S
   MODE    EXTRACTION      EIGENVALUE          RADIANS           CYCLES          GENERALIZED       GENERALIZED
    NO.       ORDER                                                                 MASS            STIFFNESS
        1         1      3.553058E+02      1.884956E+01      3.000000E+00      1.000000E+00      3.553058E+02
1    WING                              NOVEMBER  22, 2026  MSC.NASTRAN 11/22/24   PAGE    12
        2         2      1.395326E+04      1.181239E+02      1.880000E+01      1.000000E+00      1.395326E+04
1    WING                              NOVEMBER  22, 2026  MSC.NASTRAN   PAGE    13

                                MODAL PARTICIPATION FACTORS
      MODE       T1              T2              T3              R1              R2              R3
        1     2.200000E+00     0.0             0.0             0.0             0.0            -1.9+0
1    WING   NOVEMBER  22, 2026  NASTRAN  14
        2     1.200000D+00     0.0             5.0-1           0.0             0.0            -3.000000E-01

                                MODAL EFFECTIVE MASS FRACTION
      MODE       T1              T2              T3              R1              R2              R3
        1     6.1-1            0.0             0.0             0.0             0.0             9.7-1
"""
WITH_FREQUENCY = """  P A R T I C I P A T I O N   F A C T O R S
  MODE  FREQUENCY  X-COMPONENT  Y-COMPONENT  Z-COMPONENT  X-ROTATION  Y-ROTATION  Z-ROTATION
   1     3.0        2.2          0.0          0.0          0.0         0.0        -1.9
   2    18.8        1.2          0.0          0.5          0.0         0.0        -0.3
"""
# As the programs lay them out; the modes are those above.
MYSTRAN = """
                                        R E A L   E I G E N V A L U E S
    MODE  EXTRACTION   EIGENVALUE   RADIANS        CYCLES   GENERALIZED   GENERALIZED
   NUMBER   ORDER        MASS        STIFFNESS
   1   1   3.553058E+02   1.884956E+01   3.000000E+00   1.000000E+00   3.553058E+02
   2   2   1.395326E+04   1.181239E+02   1.880000E+01   1.000000E+00   1.395326E+04

                                  M O D A L   P A R T I C I P A T I O N   F A C T O R S
                        (dimensionless, in coordinate sys        0 with cols marked by R-set grid/comp)
             MODE     CYCLES         1-1           1-2
              NUM
               1  3.000000E+00  9.000000E+00  9.000000E+00

                                  M O D A L   P A R T I C I P A T I O N   F A C T O R S
                                       (dimensionless, in coordinate sys        0)
                              Reference point is the basic coordinate system origin
   MODE     CYCLES   T1   T2   T3   R1   R2   R3
              NUM
        1  3.000000E+00  2.200000E+00  0.000000E+00  0.000000E+00  0.000000E+00  0.000000E+00 -1.900000E+00
        2  1.880000E+01  1.200000E+00  0.000000E+00  5.000000E-01  0.000000E+00  0.000000E+00 -3.000000E-01
"""
CALCULIX = """
     E I G E N V A L U E   O U T P U T

 MODE NO    EIGENVALUE                       FREQUENCY
                                     REAL PART            IMAGINARY PART
                           (RAD/TIME)      (CYCLES/TIME     (RAD/TIME)

      1   0.3553058E+03   0.1884956E+02   0.3000000E+01   0.0000000E+00
      2   0.1395326E+05   0.1181239E+03   0.1880000E+02   0.0000000E+00

     P A R T I C I P A T I O N   F A C T O R S

MODE NO.   X-COMPONENT     Y-COMPONENT     Z-COMPONENT     X-ROTATION      Y-ROTATION      Z-ROTATION

      1   0.2200000E+01   0.0000000E+00   0.0000000E+00   0.0000000E+00   0.0000000E+00  -0.1900000E+01
      2   0.1200000E+01   0.0000000E+00   0.5000000E+00   0.0000000E+00   0.0000000E+00  -0.3000000E+00

     E F F E C T I V E   M O D A L   M A S S

MODE NO.   X-COMPONENT     Y-COMPONENT     Z-COMPONENT     X-ROTATION      Y-ROTATION      Z-ROTATION

      1   0.4840000E+01   0.0000000E+00   0.0000000E+00   0.0000000E+00   0.0000000E+00   0.3610000E+01
"""
_ANSYS_TABLE = """
          ***** PARTICIPATION FACTOR CALCULATION *****{:>6s} DIRECTION
        CUMULATIVE     RATIO EFF.MASS
  MODE   FREQUENCY   PERIOD   PARTIC.FACTOR     RATIO    EFFECTIVE MASS   MASS FRACTION   TO TOTAL MASS
     1     3.00000       0.33333      {:<13s}1.000000     {:<13s}   0.784215        0.598442
     2     18.8000       0.53191E-01  {:<13s}0.000002     {:<13s}   0.784215        0.307844E-11
 --------------------------------------------------------------------------------
   sum        6.28000        0.763110
"""
ANSYS = "".join(
    _ANSYS_TABLE.format(*one)
    for one in (
        ("X", "2.2000", "4.84000", "1.2000", "1.44000"),
        ("Y", "0.0000", "0.00000", "0.0000", "0.00000"),
        ("Z", "0.0000", "0.00000", "0.50000", "0.250000"),
        ("ROTX", "0.0000", "0.00000", "0.0000", "0.00000"),
        ("ROTY", "0.0000", "0.00000", "0.0000", "0.00000"),
        ("ROTZ", "-1.9000", "3.61000", "-0.30000", "0.900000E-01"),
    )
)
# Columns in another order, both of the eigenvalues and of the factors.
SHUFFLED = """  REAL EIGENVALUES
  MODE   CYCLES    RADIANS       EIGENVALUE
     1   3.0000    18.84956      355.3058
     2   18.800    118.1239      13953.26
  MODAL PARTICIPATION FACTORS
  MODE NO.  R1   R2   R3    T3   T2   T1   FREQUENCY
     1      0.0  0.0  -1.9  0.0  0.0  2.2  3.0
     2      0.0  0.0  -0.3  0.5  0.0  1.2  18.8
"""
FACTORS = (2.2, 0, 0, 0, 0, -1.9, 1.2, 0, 0.5, 0, 0, -0.3)


@pytest.mark.parametrize(
    ("text", "damping"),
    [
        (CSV, (0.005, 0.01)),
        (CSV.replace("frequency", "Frequency [Hz]").replace(",", ";").replace(".", ","), (0.005, 0.01)),
        (
            CSV.replace("frequency,damping_ratio", "frequency [kHz],damping_ratio [%]")
            .replace("3,0.005", "0.003,0.5")
            .replace("18.8,0.01", "0.0188,1"),
            (0.005, 0.01),
        ),
        (PRINT, None),
        (WITH_FREQUENCY, None),
        (MYSTRAN, None),
        (CALCULIX, None),
        (ANSYS, None),
        (SHUFFLED, None),
    ],
    ids=["csv", "commas", "units", "nastran", "x", "mystran", "calculix", "ansys", "shuffled"],
)
def test_tables_are_read(text: str, damping: tuple[float, ...] | None):
    found = read_modal_table(text)
    assert found.frequency == (3.0, 18.8)
    assert found.participation == FACTORS
    assert found.damping_ratio == damping
    assert len(found.lines) == 2 and "line" in found.reading


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("frequency,tx\n1,2\n", "line 1: the header must have frequency,tx,ty,tz,rx,ry,rz, got"),
        (CSV.replace("0,0,-0.3", "0,-0.3"), "line 5: must have 8 values, got 7"),
        (CSV.replace("18.8", "eighteen"), "line 5: frequency must be a finite number, got 'eighteen'"),
        (CSV.replace("18.8", "0"), "line 5: frequency must be positive, got 0 Hz; a mode without one is"),
        (CSV.replace("0.01", "-0.01"), "line 5: damping_ratio must be zero or more and below 1, got -0.01"),
        (CSV.replace("2.2,0,0,0,0,-1.9", "0,0,0,0,0,0"), "line 3: tx to rz must be other than six zeros"),
        (WITH_FREQUENCY.replace("2.2", "0.0").replace("-1.9", "0.0"), "line 3: tx to rz must be other than"),
        ("frequency,tx,ty,tz,rx,ry,rz\n", "line 1: must have at least one mode below the header"),
        ("nothing\n", "line 1: must be CSV with the header"),
        (CSV.replace("0.01", "2"), "line 5: damping_ratio must be zero or more and below 1, got 2; 2 %"),
        (CSV + CSV.splitlines()[2], "line 6: a mode must stand once, got that of line 3 again"),
        (CSV + CSV, "line 7: frequency must be a finite number, got 'frequency'"),
        (PRINT.replace("1.000000E+00      1.395326E+04", ""),
         "line 8: a row of the REAL EIGENVALUES must have 7 (MODE, ORDER, EIGENVALUE, RADIANS"),
        (PRINT.replace("1.395326E+04\n", "1.395326E+04 0.0\n"),
         "line 8: a row of the REAL EIGENVALUES must have 7 (MODE, ORDER, EIGENVALUE, RADIANS"),
        (PRINT.replace("1.880000E+01", "1.880010E+01"),
         "line 8: CYCLES of mode 2 must be its RADIANS over 2 pi, 18.8 Hz, got 18.8001"),
        (PRINT.replace("1.181239E+02", "1.181260E+02"),
         "line 8: RADIANS of mode 2 must be the root of its EIGENVALUE, 118.12"),
        (PRINT.replace("        2         2      1.395", "        1         2      1.395"),
         "line 8: mode 1 must appear once, got a second one; keep one subcase"),
        (PRINT.replace("2      1.395326E+04", "2     -1.395326E+04"),
         "line 15: frequency must be positive, got -18.8 Hz"),
        (PRINT[: PRINT.index("     MODAL PART")] + WITH_FREQUENCY.replace("18.8", "19.0"),
         "line 14: FREQUENCY of mode 2 must be its CYCLES among the REAL EIGENVALUES, 18.8 Hz, got 19"),
        (PRINT.replace("1.000000E+00      1.395", "2.5 1.395"),
         "line 8: the generalized mass of mode 2 must be 1, got 2.5"),
        (PRINT.replace("        2         2      1.395", "    text 1.395"),
         "mode 2 of the participation factors"),
        (ANSYS.replace("4.84000", "4.85000"),
         "line 5: EFFECTIVE MASS of mode 1 must be the square of its PARTIC.FACTOR, 4.84, got 4.85"),
        (ANSYS.replace("0.00000", "0.0000 7", 1), "line 6: must have 8 numbers, got 9"),
        (ANSYS[: ANSYS.index("  ROTY")], "line 5: mode 1 must have a factor in each DIRECTION, got none in"),
        (ANSYS + ANSYS, "line 53: mode 1 must stand once in direction X, got it again; keep one load step"),
        (ANSYS[:300] + ANSYS[300:].replace("18.8000", "18.9000").replace("18.9000", "18.8000", 1),
         "line 14: FREQUENCY of mode 2 must be in the other tables, 18.8 Hz, got 18.9"),
        (CALCULIX.replace("0.1884956E+02   0.3000000E+01   0.0000000E+00",
                          "0.0000000E+00   0.0000000E+00   0.1884956E+02"),
         "line 8: the frequency of mode 1 must be real, got an imaginary"),
        (CALCULIX.replace("0.3000000E+01", "0.3000100E+01"), "line 8: CYCLES of mode 1 must be its RADIANS"),
        (MYSTRAN[: MYSTRAN.rindex("M O D A L")], "line 1: must be CSV with the header"),
        (WITH_FREQUENCY.replace("0.0        -0.3", "-0.3"), "line 4: must have 8 numbers, got 7"),
        (WITH_FREQUENCY.replace("   2    18.8", "   1    18.8"),
         "line 4: mode 1 must appear once, got a second one"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_with_its_line(text: str, said: str):
    with pytest.raises(BadModalTableError) as error:
        read_modal_table(text)
    assert str(error.value).startswith(said)
    assert "\n" not in str(error.value)


def test_a_scenario_takes_its_modes_from_a_file(tmp_path: Path):
    """Damping for all modes beside a table that has none; a mistake in the file is one line with its name."""
    (tmp_path / "modes.f06").write_text(PRINT)
    table = {"kind": "modal-data", "file": str(tmp_path / "modes.f06"), "damping_ratio": 0.003}
    overrides = {"flexible.wing": {**table, "link": "body"}}
    made = load_scenario("bai2020", case="case1", overrides=overrides).flexible["wing"].build()
    assert made.frequency == (3.0, 18.8)
    assert made.participation == FACTORS
    assert made.damping_ratio == (0.003,)
    (tmp_path / "modes.f06").write_text(PRINT.replace("-1.9+0", "x"))
    with pytest.raises(AntennaPinError, match=r"modes\.f06.*line 13: a factor must be a finite number"):
        load_scenario("bai2020", case="case1", overrides=overrides)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (
            "18.8,0.01,1.2,",
            "18.8,0.01,50,",
            r"line 5, column tx: an effective mass of 2500 kg, of the link's 2400 kg",
        ),
        (
            "0,0,0,0,-1.9",
            "0,0,90,0,0",
            r"line 3, column rx: an effective moment of inertia about the root of 8100",
        ),
    ],
)
def test_an_impossible_mode_is_named_by_line_and_column(tmp_path: Path, old: str, new: str, says: str):
    """Also from a scenario that a result carries, when the file may be elsewhere."""
    (tmp_path / "modes.csv").write_text(CSV.replace(old, new))
    table = {"kind": "modal-data", "file": str(tmp_path / "modes.csv"), "link": "body"}
    scenario = load_scenario("bai2020", case="case1", overrides={"flexible.wing": table})
    for one in (scenario, Scenario.model_validate_json(scenario.model_dump_json())):
        with pytest.raises(AntennaPinError, match=rf"flexible.wing: wing_mode\d .*modes\.csv, {says}"):
            build_system(one)
    (tmp_path / "other.csv").write_text(CSV)
    other = scenario.with_overrides({"flexible.wing.file": str(tmp_path / "other.csv")})
    assert other.flexible["wing"].build().places == tuple(f"{tmp_path}/other.csv, line {k}" for k in (3, 5))


def test_more_modes_than_memory_holds_are_refused_before_any_work(tmp_path: Path, monkeypatch):
    """With room for 5 freedoms: six modes beside three joints."""
    monkeypatch.setattr(capacity, "free_memory", lambda: 96 * 5.01**3 / 0.9)
    monkeypatch.setattr("antenna_pin.mechanism.flexible.modal_data.realised", None)
    (tmp_path / "modes.csv").write_text(
        CSV + "".join(f"{hertz},0.01,0.1,0,0,0,0,0\n" for hertz in range(20, 24))
    )
    table = {"kind": "modal-data", "file": str(tmp_path / "modes.csv"), "link": "body"}
    scenario = load_scenario("bai2020", case="case1", overrides={"flexible.wing": table})
    with pytest.raises(TooLargeError, match=r"flexible\.wing: 9 degrees of freedom .*take the modes"):
        build_system(scenario)
    with pytest.raises(TooLargeError, match=r": 8 degrees of freedom would need .*leave joints out"):
        build_system(load_scenario("bai2020", case="case1"))
