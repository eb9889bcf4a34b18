"""The lower level: from a URDF to a system with a clearance joint, a drive and a spring, and a run of it."""

from pathlib import Path

from antenna_pin import ClearanceJoint, ErrorScales, RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.contact import MATERIALS, LankaraniNikravesh, Tanh, hertz_stiffness
from antenna_pin.dynamics import JointSpring, SineDrive
from antenna_pin.joints.geometry import RevoluteClearance

urdf = Urdf.load(Path(__file__).parent / "panel" / "panel.urdf")
mechanism = build_mechanism(urdf.variant(joints={"hinge": "free"}), base="free")

shape = RevoluteClearance.from_clearances(
    bearing_radius=5e-3,
    radial_clearance=50e-6,
    bearing_length=40e-3,
    axial_clearance=100e-6,
    bearing_outer_radius=7e-3,
    flange_radius=8e-3,
)
steel = MATERIALS["steel"]
stiffness = hertz_stiffness(shape.bearing_radius, shape.journal_radius, steel, steel)  # [N/m^1.5]
law = LankaraniNikravesh(stiffness=stiffness, restitution=0.8)
hinge = ClearanceJoint(
    name="hinge",
    geometry=shape,
    radial=law,
    axial=law,
    friction=Tanh(coefficient_of_friction=0.1, transition_speed=1e-3),
    backend="closed-form",
)
system = System(
    mechanism,
    clearances=[hinge],
    drives={"motor": SineDrive(joint="hinge", amplitude=0.2, frequency=2.0)},
    springs={"coil": JointSpring(joint="hinge", stiffness=0.5, damping=0.02, rest_angle=-1.5708)},
)
settings = RunSettings(rtol=1e-9, output_rate=2000.0, scales=ErrorScales(clearance_velocity=1e-3))
run = simulate(system, duration=0.2, settings=settings)

print(run.outcome.name)
print("angle at the end [rad]:", run.data["motion_angle"].sel(joint="hinge")[-1].item())
print("largest force [N]:", run.data["peak_force"].max().item())
