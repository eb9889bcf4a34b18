"""Scenarios: validated data in SI units from a TOML file, nothing computed.

``load_scenario("bai2020", case="case3")`` returns a :class:`Scenario`. A file has a base and named cases that
are laid over it; values may be overridden from outside. A bare number is SI, text carries its unit.

The names below are loaded when first used: the classes that check the parts of a scenario take a while to be
made, and who only lists what there is needs none of them.
"""

from antenna_pin.base.lazy import exported

exported(__name__)
