from antenna_pin.scenario.assemble.build import build_system as build_system
from antenna_pin.scenario.assemble.build import reference_for as reference_for
from antenna_pin.scenario.assemble.facts import scenario_facts as scenario_facts
from antenna_pin.scenario.assemble.initial import initial_angles as initial_angles
from antenna_pin.scenario.assemble.initial import initial_state as initial_state
from antenna_pin.scenario.assemble.variant import as_written as as_written
from antenna_pin.scenario.assemble.variant import urdf_variant as urdf_variant
