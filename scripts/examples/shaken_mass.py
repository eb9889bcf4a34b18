"""A mass on a spring on a base that swings at its resonance: how far it gets, and what the base must push."""

from antenna_pin import System, Urdf, build_mechanism, simulate
from antenna_pin.analysis import base_loads
from antenna_pin.dynamics import assembled
from antenna_pin.elements import JointSpring, SineShake
from antenna_pin.mechanism import with_shaken_base

LINK = """<link name="{0}"><inertial><mass value="{1}"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
SLIDE = """<joint name="slide" type="prismatic"><parent link="table"/><child link="mass"/><axis xyz="1 0 0"/>
  <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>"""
text = f"<robot name='rig'>{LINK.format('table', 2)}{SLIDE}{LINK.format('mass', 1)}</robot>"
shake = SineShake(joint="x", direction=(1, 0, 0), frequency=5.0, acceleration=1.0, fade_in=1.0)
mechanism = build_mechanism(with_shaken_base(Urdf.from_text(text, "rig"), {"x": shake}), "fixed")
spring = JointSpring(joint="slide", stiffness=986.96, damping=3.0)
system = System(mechanism, drives={"x": shake}, springs={"slide": spring})
q, v = assembled(system, system.neutral())
run = simulate(system, duration=6.0, q=q, v=v)
print(f"at most {1e3 * abs(run.data.q[:, 1]).max().item():.2f} mm")  # 1/(2 zeta w^2) = 10.61 mm at last
print(f"force on the table at most {abs(base_loads(run).force).max().item():.3f} N")
