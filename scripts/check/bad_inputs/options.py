"""Bad inputs: options and arguments of commands."""

from __future__ import annotations

import re
from collections.abc import Iterator

from bad_inputs.case import FILES, Case
from bad_inputs.results import write_result

# Behind the beginning of a command each of its ends, and what must be said. No shell: words are parted at
# blanks, "·" is a blank in a word, and of "{a;b}" there is a command with each.
_COMMANDS = """
: fly > No such command 'fly' | --fly > No such option: --fly
run: > must be given a SCENARIO | no.toml > no such file | bai2021 > did you mean bai2020
    empty > has no scenario.toml | run.nc > is not | pair.urdf > is not TOML
    /dev/zero > must be a regular file, got a device
run scenario.toml: --case > requires an argument | scenario.toml > unexpected extra argument
    --case pay > did you mean play | --case · > case | --duration {0;-1} > duration must be positive
    --duration nan > not finite | --duration 1e400 > duration must be
    --duration long > duration must be a time | --duration 1e30 > in a run of | --geometry cole > --geometry
    --engine fast > --engine
run scenario.toml --set: rtol > must be KEY=VALUE | {=1;a..b=1;drives.motor.time[0]=1} > keys joined by dots
    integrator.rtl=1 > did you mean rtol | integrator=1 > integrator must be a table
    integrator.rtol.x=1 > integrator.rtol | title=1 > title must be text | cases.play.title=x > choose a case
    format=true > format must be 1 | integrator.scales=1 > scales must be a table
    clearance.hinge.strips='4' > strips must be | clearance.hing.strips=4 > clearance.hing
    initial.joints.hinge.angle=1e300 > up to where a double holds it
    initial.base.position=[1e17,0,0] > position[0] must be at most 8.6e+09 m
run scenario.toml --out: out.nc --fly > No such option: --fly | {out.txt;/dev/full} > must end in .nc
    . > got a folder | {no/out.nc;run.nc/out.nc;/dev/full.nc/x.nc} > does not exist | /proc/out.nc > writable
info: > Missing argument | no.nc > no such file | empty > | run.nc scenario.toml > one scenario alone
    run.nc --case play > is for scenarios only | run.nc --set a=1 > is for scenarios only
    table.csv > must be a NetCDF file | /dev/zero > must be a regular file, got a device
plot: run.nc > Missing option '--out' | run.nc --out run.nc > this is a file | run.nc --out /proc/f >
    no.nc --out f > no such file
plot run.nc --out f: --format bmp > figure format 'bmp' is unknown | --format , > figure format
    --width wide > --width | --figure energi > did you mean energy | --joint hing > hing
record run.nc: > Missing option '--out' | --out a.avi > must end in .html | --out no/a.html > does not exist
record run.nc --out a.html: --fps 30 > --fps | --size 10x10 > --size | --at 0 > --at
    --speed {1e400;1e-400;0;nan;1e999999999} > speed must be | --speed {1/0;fast;1/2/3} > --speed
    --key-rate 0 > must be positive | --key-rate inf > --key-rate | --max-size nan > --max-size
    --max-size 0 > must be positive | --max-size 1e-9 > max | --start 1 --end 0 > start
    --start 5 > start | --end nan > --end | --start 1·m > --start must be a time | --view side > --view
    --body bra > bra | --ideal no.nc > no such file
record run.nc --out a.html --view joint: --joint hing > hing | --magnify {0;nan;1e300} > magnify
record run.nc --out a.html --body bar --boresight: {1,0;0,0,0;a,b,c;nan,0,0} > boresight
record run.nc --out a.mp4: --at 0 > --at | --fps {inf;nan;many} > --fps | --fps {0;-1;1e9} > fps must be
    --size 10 > --size | --size {0x0;11x11;99999x99999} > size must be
record run.nc --out a.png: --size ١٠x١٠ > --size | --at 5 > within the recording
    --at later > --at must be a time
report: run.nc > Missing option '--out' | run.nc --out a.pdf > must end in .html
    no.nc --out a.html > no such file | table.csv --out a.html > must be a NetCDF file
report run.nc --out a.html: --window {0;-1} > window | --window nan > --window
    --window 1·m > --window must be a time
analyse: > Missing argument | no.nc > no such file | run.nc --ideal table.csv > must be a NetCDF file
    run.nc --longest-gap long > --longest-gap | run.nc --longest-gap -1 > longest_gap must be
    run.nc --longest-gap nan > --longest-gap must be
impacts run.nc: --strongest {0;many} > --strongest | --joint hing > hing | --csv {no/a.csv;.} >
    --strongest 1_0 > '1_0' is not a valid int
pointing run.nc: > | --body bar --boresight 1,0,0 --direction 1,0 > --direction
    --body bar --boresight 1,0,0 --direction 0,0,0 > direction
    --body bar --boresight 0,0,0 --direction 1,0,0 > boresight
    --body bra --boresight 1,0,0 --direction 1,0,0 > bra
    --body bar --boresight 1_0,0,0 --direction 1,0,0 > three numbers such as 1,0,0
pointing run.nc --body bar --boresight 1,0,0 --direction 1,0,0: --confidence {2;nan} > confidence
    --window {0;nan} > window | --period inf > period | --drift-spacing -1 > drift_spacing
figures: > Missing argument | bai2021 > did you mean bai2020 | scenario.toml --case pay > pay
    scenario.toml --format bmp > figure format | scenario.toml --out run.nc > this is a file
urdf scenario.toml: --out a.xml > must end in .urdf | --out no/a.urdf > does not exist
    --case pay > did you mean play
contact: fly > No such command 'fly' | curve hertzz > hertz | curve --depths {,;a;-1} > --depths
    curve --bearing-radius 0 > --bearing-radius | curve --radial-clearance 1 > --radial-clearance
    curve --material stel > did you mean steel | restitution no-law > no-law | restitution --restitutions 2 >
    restitution --mass 0 > --mass | scenarios --bearing-length 1·s > --bearing-length
    scenarios --flange-radius 1·mm >
"""
_LONG = (
    (f"run scenario.toml --set {'a.' * 3000}a=1", "keys joined by dots"),
    (f"run scenario.toml --set {'a' * 100_000}=1", "letters"),
    (f"run scenario.toml --out {'o' * 300}.nc", "File name too long"),
    (f"run scenario.toml --out {'o/' * 3000}x.nc", ""),
    (f"record run.nc --out a.png --size {'9' * 5000}x{'9' * 5000}", "--size"),
)


def _commands() -> Iterator[tuple[str, str]]:
    begin = ""
    for line in _COMMANDS.strip("\n").splitlines():
        if not line.startswith(" "):
            begin, _, line = line.partition(": ")
        for end in line.split(" | "):
            words, _, says = f"{begin} {end.strip()} ".partition(" > ")
            before, *each = re.split("[{;}]", words.strip())
            yield from ((before + one, says.strip()) for one in each[:-1] or [""])
    yield from _LONG


def cases() -> Iterator[Case]:
    """Yield all of them."""
    files = FILES | {
        "table.csv": "time,torque\n0,1\n1,2\n",
        "run.nc": write_result,
        "empty": lambda path: path.mkdir(),
    }
    for command, says in _commands():
        words = tuple(word.replace("·", " ") for word in command.split())
        name = command if len(command) < 100 else f"{command[:60]}... ({len(command)} letters)"
        yield Case("options", name, says, words, files)
