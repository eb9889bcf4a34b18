"""Bad inputs: scenario files, the tables that they name, and quantities."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from bad_inputs.case import FILES, MECHANISM, SCENARIO, Case, changed

_COMMAND = ("run", "scenario.toml", "--out", "out.nc", "--no-progress")

_FORMAT = "format = 1\n"
_TABLE = "time = [0, 1, 2]\ntorque = [0, 1, 0]\n"
_LAW = 'normal = { law = "lankarani-nikravesh", restitution = 0.8 }'
_RTOL = "rtol = 1e-8"
_MODEL = 'model = "contact"'
_INTEGRATOR = "[integrator]"
_MATERIAL = "[materials.x]\nyoung = 1e9"
_CLEARANCES = '"0.1 mm"\nbearing_l'
_DEEP = 2000


def _more(text: str, before: str = "[output]") -> tuple[str, str]:
    """Return what is replaced, and by what, for a text to stand before a table."""
    return before, f"{text}\n{before}"


# What is wrong: what is replaced, by what, and what must be said.
_CHANGES: tuple[tuple[str, str, str, str], ...] = (
    ("format of text", _FORMAT, 'format = "1"\n', "format"),
    ("format true", _FORMAT, "format = true\n", "format"),
    ("format 2", _FORMAT, "format = 2\n", "format"),
    ("format 1.5", _FORMAT, "format = 1.5\n", "format"),
    ("format of 5,000 digits", _FORMAT, f"format = {'9' * 5000}\n", "digits"),
    ("title a number", 'title = "A bar on a hinge with play"', "title = 3", "title must be text"),
    ("no duration", 'duration = "1 ms"\n', "", "duration is missing"),
    ("duration negative", '"1 ms"', '"-1 ms"', "duration must be positive"),
    ("duration zero", '"1 ms"', "0", "duration must be positive"),
    ("duration infinite", '"1 ms"', "inf", "not finite"),
    ("duration nan", '"1 ms"', "nan", "not finite"),
    ("duration true", '"1 ms"', "true", "duration must be a time"),
    ("duration a date", '"1 ms"', "2020-01-01", "duration must be a time"),
    ("duration an array", '"1 ms"', "[1]", "duration must be a time"),
    ("duration a length", '"1 ms"', '"1 mm"', "(length)"),
    ("default case unknown", 'default_case = "play"', 'default_case = "pay"', "did you mean play"),
    ("default case a number", 'default_case = "play"', "default_case = 1", "default_case must be text"),
    ("cases an array", '[cases.play]\ndescription = "with play"', "", ""),
    ("case a number", '[cases.play]\ndescription = "with play"', "[cases]\nplay = 1", "cases.play must be"),
    ("description a number", '"with play"', "1", "description must be text"),
    ("key unknown", "[integrator]", "[integrater]", "did you mean integrator"),
    ("key of a table unknown", _RTOL, "rtl = 1e-8", "did you mean rtol"),
    ("key in other letters", _RTOL, '"ртол" = 1e-8', "is unknown"),
    ("key empty", _RTOL, '"" = 1', "is unknown"),
    ("key that only a loaded scenario has", _FORMAT, _FORMAT + 'urdf_text = "a"\n', "urdf_text is unknown"),
    ("key replace", _RTOL, "replace = true", "belongs in a table of a case"),
    ("key of 3,000 parts", _RTOL, ".".join("a" * 3000) + " = 1", "deep"),
    ("table of 3,000 parts", "[integrator]", "[" + ".".join("a" * 3000) + "]", "deep"),
    ("arrays 2,000 deep", _RTOL, f"rtol = {'[' * _DEEP}{']' * _DEEP}", "deep"),
    ("tables 2,000 deep", _RTOL, f"rtol = {'{a=' * _DEEP}1{'}' * _DEEP}", "deep"),
    ("arrays 150 deep", _RTOL, f"rtol = {'[' * 150}{']' * 150}", "deep"),
    ("integer of 5,000 digits", _RTOL, f"rtol = {'1' * 5000}", "digits"),
    ("integer of 400 digits", _RTOL, f"rtol = {'1' * 400}", "rtol must be"),
    ("hexadecimal of 5,000 digits", _RTOL, f"rtol = 0x{'1' * 5000}", ""),
    ("float of 5,000 digits", _RTOL, f"rtol = {'1' * 5000}.0", "rtol must be"),
    ("float that overflows", _RTOL, "rtol = 1e999", "rtol must be"),
    ("table twice", "[output]", "[integrator]\n[output]", "is not TOML"),
    ("key twice", _RTOL, f"{_RTOL}\n{_RTOL}", "is not TOML"),
    ("no value", _RTOL, "rtol =", "is not TOML"),
    ("text not closed", '"1 kHz"', '"1 kHz', "is not TOML"),
    ("control character", '"1 kHz"', '"1 \x1bkHz"', "is not TOML"),
    ("escape unknown", '"1 kHz"', '"1 \\qkHz"', "is not TOML"),
    ("rtol true", _RTOL, "rtol = true", "rtol must be a pure number"),
    ("rtol 5", _RTOL, "rtol = 5", "rtol must be"),
    ("rtol 0", _RTOL, "rtol = 0", "rtol must be"),
    ("rtol below round-off", _RTOL, "rtol = 1e-20", "round-off"),
    ("rtol text", _RTOL, 'rtol = "small"', "rtol must be a pure number"),
    ("scales a number", _RTOL, "scales = 1", "scales must be a table"),
    ("scale zero", _RTOL, "scales = { angle = 0 }", "angle must be positive"),
    ("scale unknown", _RTOL, "scales = { angel = 1 }", "did you mean angle"),
    ("method unknown", _RTOL, 'method = "euler"', "method must be"),
    ("method a number", _RTOL, "method = 4", "method must be"),
    ("engine unknown", _RTOL, 'engine = "fast"', "engine must be"),
    ("rk4 without end", _RTOL, 'method = "rk4"\nstep = 1e-20', "step"),
    ("rk4 with a million times a million steps", _RTOL, 'method = "rk4"\nstep = 1e-15', "step"),
    ("rk4 with a step as long as it likes", _RTOL, 'method = "rk4"\nstep = 0', "step must be positive"),
    ("longest step without end", _RTOL, "max_step = 1e-25", "max_step"),
    ("longest step below round-off", _RTOL, "max_step = 1e-20\nmin_step = 1e-22", "max_step"),
    ("least step above the longest", _RTOL, "min_step = 1\nmax_step = 1e-3", "min_step must be below"),
    ("first step above the longest", _RTOL, "first_step = 1", "first_step must be from min_step"),
    ("steps of half", _RTOL, "max_steps = 0.5", "max_steps must be"),
    ("steps infinite", _RTOL, "max_steps = inf", "max_steps must be"),
    ("wall time zero", _RTOL, "max_wall_time = 0", "max_wall_time must be positive"),
    ("times that go back", '"1 kHz"', '"1 kHz"\ntimes = [0.2, 0.1]', "output.times[1] must be above"),
    ("a time past the end", '"1 kHz"', '"1 kHz"\ntimes = [9.0]', "output.times must be at most 0.001 s"),
    ("a time in metres", '"1 kHz"', '"1 kHz"\ntimes = ["1 m"]', "output.times[0] must be a time"),
    ("rate zero", '"1 kHz"', "0", "output.rate must be positive"),
    ("rate angular", '"1 kHz"', '"1 rad/s"', "output.rate must be a frequency"),
    ("rate without bounds", '"1 kHz"', "1e12", "output.rate"),
    ("rate a hundred times without bounds", '"1 kHz"', '"1e300 Hz"', "output.rate"),
    ("form unknown", 'rate = "1 kHz"', 'form = "fat"', "form must be"),
    ("no mechanism", '[mechanism]\nurdf = "pair.urdf"\n', "", "mechanism is missing"),
    ("mechanism text", "[mechanism]\nurdf =", "mechanism =", ""),
    ("URDF not there", '"pair.urdf"', '"par.urdf"', "did you mean pair.urdf"),
    ("URDF a folder", '"pair.urdf"', '"."', "must be an existing file"),
    ("URDF a number", '"pair.urdf"', "3", "urdf must be text"),
    ("URDF with a null", '"pair.urdf"', '"pair\\u0000.urdf"', "urdf"),
    ("URDF of 5,000 letters", '"pair.urdf"', f'"{"u" * 5000}.urdf"', "urdf"),
    ("gravity of two", "[mechanism]", "[mechanism]\ngravity = [0, 1]", "gravity must be an array of 3"),
    ("gravity nested", "[mechanism]", "[mechanism]\ngravity = [[0], [1], [2]]", "gravity[0]"),
    ("base unknown", "[mechanism]", '[mechanism]\nbase = "fre"', "did you mean free"),
    ("joint unknown", "[clearance.hinge]", "[clearance.hing]", "did you mean hinge"),
    ("joint of 100,000 letters", "[clearance.hinge]", f"[clearance.{'h' * 100_000}]", "letters"),
    ("model unknown", _MODEL, 'model = "contct"', "contact"),
    ("model a table", _MODEL, "model = {}", "model"),
    ("no model", 'model = "contact"\n', "", "model"),
    ("clearance as wide as the bearing", _CLEARANCES, '"10 mm"\nbearing_l', "journal_radius positive"),
    ("clearance negative", _CLEARANCES, '"-0.1 mm"\nbearing_l', "must be positive"),
    ("both clearances", _CLEARANCES, '"0.1 mm"\njournal_radius = 0.01\nbearing_l', "exactly one of"),
    ("no clearance", 'radial_clearance = "0.1 mm"\n', "", "exactly one of"),
    ("strips text", _MODEL, 'model = "contact"\nstrips = "4"', "strips must be"),
    ("strips odd", _MODEL, 'model = "contact"\nstrips = 5', "strips must be"),
    ("strips of half", _MODEL, 'model = "contact"\nstrips = 4.5', "strips must be"),
    ("strips true", _MODEL, 'model = "contact"\nstrips = true', "strips must be"),
    ("strips without bounds", _MODEL, 'model = "contact"\nstrips = 1_000_000_000', "strips must be"),
    ("sectors two", _MODEL, 'model = "contact"\nsectors = 2', "sectors must be"),
    ("sectors without bounds", _MODEL, 'model = "contact"\nsectors = 1000000000', "sectors must be"),
    ("flange smaller than the bearing", '"14 mm"', '"9 mm"', "must be above"),
    ("material unknown", '"steel"', '"stel"', "did you mean steel"),
    ("material without Poisson", *_more(_MATERIAL, _INTEGRATOR), "poisson is missing"),
    ("Poisson's ratio of 1", *_more(f"{_MATERIAL}\npoisson = 1", _INTEGRATOR), "poisson must be"),
    *(
        (f"spring: {key} as {value}", "[springs.hinge]", f"[springs.hinge]\n{key} = {value}", "true or false")
        for key in ("on", "shorter_way")
        for value in ('"no"', "1", '"off"', "0.0")
    ),
    ("guess of text", *_more('[initial.joints.hinge]\nguess = "no"'), "guess must be true or"),
    *(
        (f"{key} beside the journal's", *_more(f"[initial.joints.hinge]\n{key} = 0\n{journal}"), says)
        for keys, journal, says in (
            (
                "rate velocity",
                "journal_angular_velocity = [0, 0, 5]",
                "journal_angular_velocity[2], which sets",
            ),
            ("angle", "journal_tilt = [0, 0, 0.1]", "leave out angle, or make journal_tilt[2] zero"),
            ("position", "journal_tilt = [0, 0, 0.1]", "got 0 and 0.1"),
        )
        for key in keys.split()
    ),
    ("law unknown", "lankarani-nikravesh", "lankarani-nikravish", "did you mean lankarani-nikravesh"),
    ("law a number", _LAW, "normal = 3", "normal"),
    ("law without name", _LAW, "normal = { restitution = 0.8 }", "law"),
    ("restitution above one", "restitution = 0.8", "restitution = 1.2", "restitution must be"),
    ("restitution missing", ", restitution = 0.8", "", "restitution is missing"),
    ("restitution in percent", "restitution = 0.8", 'restitution = "90 %%"', "restitution must be"),
    ("friction unknown", '"tanh"', '"tan"', "did you mean tanh"),
    ("friction negative", "_friction = 0.1", "_friction = -0.1", "coefficient_of_friction must be"),
    ("spring at nothing", "[springs.hinge]", "[springs.hing]", "hing"),
    ("stiffness of a wire", '"0.5 N*m/rad"', '"0.5 N/m"', "stiffness"),
    ("damping negative", '"0.02 N*m*s/rad"', '"-0.02 N*m*s/rad"', "damping must be"),
    ("drive of no kind", 'kind = "table"\n', "", "kind"),
    ("drive of a kind unknown", 'kind = "table"', 'kind = "tabel"', "table"),
    ("drive of no joint", 'joint = "hinge"', 'joint = "hing"', "did you mean hinge"),
    ("table too short", _TABLE, "time = [0]\ntorque = [0]\n", "time"),
    ("table that goes back", "[0, 1, 2]", "[0, 2, 1]", "must be above the one before"),
    ("table of two lengths", "[0, 1, 0]", "[0, 1]", "torque"),
    ("table that ends early", "[0, 1, 2]", "[0, 1e-5, 2e-5]", "motor"),
    ("table with text", "[0, 1, 0]", '[0, "a", 0]', "torque[1]"),
    ("table with units", "[0, 1, 0]", '[0, "1 N", 0]', "torque[1]"),
    ("table file and numbers", _TABLE, _TABLE + 'file = "a.csv"\n', "got both"),
    ("initial state of no joint", *_more("[initial.joints.hing]\nangle = 0"), "did you mean hinge"),
    ("event of no kind", "[output]", "[events.e]\n[output]", "kind"),
    ("event at a contact unknown", *_more('[events.e]\nkind = "gap"\ncontact = "x"\nvalue = 0'), "x"),
    ("event sets nothing", *_more('[events.e]\nkind = "time"\ntime = 1e-4\naction = "set"'), "set"),
    ("closure of no kind", "[output]", "[closures.c]\n[output]", "kind"),
    ("flexible link unknown", "[output]", '[flexible.x]\nkind = "modes"\n[output]', "x"),
    ("pointing of no link", "[output]", '[pointing]\nbody = "bra"\n[output]', "pointing"),
)

# Whole files.
_FILES: tuple[tuple[str, str | bytes, str], ...] = (
    ("empty file", "", "missing"),
    ("zeros", bytes(100), "is not TOML"),
    ("Latin 1", SCENARIO.replace("bar", "bär").encode("latin-1"), "is not UTF-8 text"),
    ("UTF-16", SCENARIO.encode("utf-16"), "is not UTF-8 text"),
    ("JSON", '{"format": 1}', "is not TOML"),
    ("YAML", "format: 1\n", "is not TOML"),
    ("a URDF", MECHANISM, "is not TOML"),
    ("cut off", SCENARIO[:-20], "is not TOML"),
)

_CSV: tuple[tuple[str, str | bytes, str], ...] = (
    ("empty table", "", "the header must have time,torque"),
    ("no header", "0,1,2\n1,2,3\n", "the header must have time,torque"),
    ("thousands", "time;torque\n0;1,000\n1;2,000\n", "of decimals or thousands"),
    ("one row", "time,torque\n0,1\n", "at least 2 rows"),
    ("three values", "time,torque\n0,1,2\n1,1,2\n", "must have 2 values, got 3"),
    ("words", "time,torque\n0,a\n1,2\n", "torque must be a finite number"),
    ("nan", "time,torque\n0,nan\n1,2\n", "torque must be a finite number"),
    ("time goes back", "time,torque\n0,1\n0,2\n", "time must increase strictly"),
    ("a field above 131,072 letters", f"time,torque\n0,{'1' * 200_000}\n1,2\n", "line 2"),
    ("a header above 131,072 letters", f"time,{'t' * 200_000}\n0,1\n1,2\n", "line 1"),
    ("a quote not closed", 'time,torque\n0,"1\n1,2\n', ""),
    ("zeros", bytes(100), ""),
    ("Latin 1", "time,torque\n0,1\n1,2 # schön\n".encode("latin-1"), "UTF-8 text"),
)

# Quantities, each set as a duration, a positive time, by what must be said.
_TIMES: Mapping[str, tuple[str, ...]] = {
    "duration must be a time": (
        *("1 s**9**9**9", "1 9**9**9*s", "1 s**99999999999", "1 s*(9**9**9)", "1 s**(1e300)"),
        *(f"1 {'s*' * 50_000}s", f"1 {'(' * 5000}s{')' * 5000}", f"1 {'s' * 100_000}", f"{'1' * 100_000} s"),
        *("1 s**-1", "1/0 s", "1 s/0", "1 0*s", "1 -s", "0x10 s", "1_000 s", "1,500 s", "\u0661 s"),
        *("1 s\nimport os", "1 \x1b[31ms", "1 __import__('os')", "1 s.real", "1 s;s", "1 s**s", "1 s**0.1"),
        *("[1]", "{a=1}", "2020-01-01", "true", "9" * 5000, "[" * 2000 + "]" * 2000, "1 \u017f"),
    ),
    "(length)": ("1 furlong",),
    "unit 'degC' is unknown": ("1 degC",),
    "unit 'dB' is unknown": ("1 dB",),
    "unit": ("1 sec onds",),
    "duration": ("1 s s", "1 %", "90 %%"),
    "": ("1 s %",),
    "(frequency)": ("1 Hz",),
    "(angular rate)": ("1 rad/s",),
    "not finite": ("1e400 s", "nan s", "inf s"),
    "duration must be positive": ("1e-400 s", "-1 s"),
    "write a number and its unit": ("s", "", "one s"),
}


def cases() -> Iterator[Case]:
    """Yield all of them."""
    for name, old, new, says in _CHANGES:
        yield Case("toml", name, says, _COMMAND, FILES | {"scenario.toml": changed(SCENARIO, old, new)})
    for name, text, says in _FILES:
        yield Case("toml", name, says, _COMMAND, FILES | {"scenario.toml": text})
    scenario = changed(SCENARIO, _TABLE, 'file = "table.csv"\n')
    for name, text, says in _CSV:
        files = FILES | {"scenario.toml": scenario, "table.csv": text}
        yield Case("toml", f"table: {name}", says, _COMMAND, files)
    for says, texts in _TIMES.items():
        for text in texts:
            name = text if len(text) < 40 else f"{text[:20]}... ({len(text)} letters)"
            yield Case("units", name, says, (*_COMMAND, "--set", f"duration={text}"), FILES)
