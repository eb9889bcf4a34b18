#!/usr/bin/env python3
"""One impact in other simulators, beside the law here that is theirs.

    python scripts/peers/one_impact.py

A ball of 1 kg, then one of 10 kg, comes upon a fixed one at 0.1 m/s, without gravity. Asked for is a linear
contact of 1e6 N/m with what each calls its dissipation; found are the share of the speed that is left and the
largest force, each beside those of the law that docs/coming-from names, integrated to 1e-12. Those of MuJoCo,
Drake and Exudyn are asked that can be imported; none is a dependency (``pip install mujoco drake exudyn`` in
an environment of one's own, where this package is too). MuJoCo's contact is a rule for accelerations: its
force is in proportion to the mass, so that the law here gets the mass as well.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable

from antenna_pin.analysis.law_studies import impact_on_wall
from antenna_pin.contact import NormalLaw
from antenna_pin.laws import CarvalhoMartins, HuntCrossley, KelvinVoigt, MarhefkaOrin

STIFFNESS, SPEED, RADIUS, GAP = 1e6, 0.1, 0.05, 1e-5  # [N/m], [m/s], [m], [m]
STEP, DURATION = 1e-6, 0.02  # [s]
MASSES = (1.0, 10.0)  # [kg]
DISSIPATION = 2.0  # Drake's, [s/m]
DAMPING = 100.0  # MuJoCo's of the reference, [1/s]
RESTITUTION = 0.8  # Exudyn's

Found = tuple[float, float]  # share of the speed that is left [-], largest force [N]


def by_mujoco(mass: float) -> Found:
    """Return what MuJoCo makes of it, asked for stiffness and damping of the reference acceleration."""
    import mujoco

    xml = f"""<mujoco><option timestep="{STEP}" gravity="0 0 0" integrator="RK4"/><worldbody>
      <geom type="plane" size="1 1 1" priority="1" solref="{-STIFFNESS} {-DAMPING}" solimp="0.99 0.99 0.001"/>
      <body pos="0 0 {RADIUS + GAP}"><joint type="slide" axis="0 0 1"/>
      <geom type="sphere" size="{RADIUS}" mass="{mass}"/></body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    data.qvel[0] = -SPEED
    largest = 0.0
    while data.time < DURATION:
        mujoco.mj_step(model, data)
        largest = max(largest, float(data.qfrc_constraint[0]))
    return float(data.qvel[0]) / SPEED, largest


def by_drake(mass: float) -> Found:
    """Return what Drake makes of it by point contact under Hunt and Crossley's law, in steps."""
    import numpy as np
    from pydrake.geometry import AddContactMaterial, HalfSpace, ProximityProperties, Sphere
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import AddMultibodyPlant, CoulombFriction, MultibodyPlantConfig
    from pydrake.multibody.tree import SpatialInertia
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder

    builder = DiagramBuilder()
    settings = MultibodyPlantConfig(
        time_step=STEP, contact_model="point", discrete_contact_approximation="lagged"
    )
    plant, _ = AddMultibodyPlant(settings, builder)
    ball = plant.AddRigidBody("ball", SpatialInertia.SolidSphereWithMass(mass, RADIUS))

    def material(stiffness: float) -> ProximityProperties:
        made = ProximityProperties()
        AddContactMaterial(
            dissipation=DISSIPATION,
            point_stiffness=stiffness,
            friction=CoulombFriction(0.0, 0.0),
            properties=made,
        )
        return made

    # The stiffness of a pair is that of two springs in a row.
    half = material(2.0 * STIFFNESS)
    plant.RegisterCollisionGeometry(ball, RigidTransform(), Sphere(RADIUS), "ball", half)
    plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(), HalfSpace(), "floor", half)
    plant.mutable_gravity_field().set_gravity_vector(np.zeros(3))
    plant.Finalize()
    diagram = builder.Build()
    simulator = Simulator(diagram)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.SetFreeBodyPose(context, ball, RigidTransform([0.0, 0.0, RADIUS + GAP]))
    velocities = plant.GetVelocities(context)
    velocities[5] = -SPEED
    plant.SetVelocities(context, velocities)
    port = plant.get_contact_results_output_port()
    largest = 0.0
    while simulator.get_context().get_time() < DURATION:
        simulator.AdvanceTo(simulator.get_context().get_time() + STEP)
        found = port.Eval(context)
        if found.num_point_pair_contacts():
            largest = max(largest, float(np.linalg.norm(found.point_pair_contact_info(0).contact_force())))
    return float(plant.GetVelocities(context)[5]) / SPEED, largest


def by_exudyn(model: int) -> Callable[[float], Found]:
    """Return what Exudyn makes of it by contact of two spheres, under one of its models of impact."""

    def found(mass: float) -> Found:
        import exudyn as exu
        import exudyn.utilities as items

        system = exu.SystemContainer().AddSystem()
        ground = system.AddObject(items.ObjectGround(referencePosition=[0.0, 0.0, -RADIUS]))
        inertia = items.InertiaSphere(mass, RADIUS)
        made = system.CreateRigidBody(
            inertia=inertia,
            referencePosition=[0.0, 0.0, RADIUS + GAP],
            initialVelocity=[0.0, 0.0, -SPEED],
            returnDict=True,
        )
        memory = system.AddNode(
            items.NodeGenericData(initialCoordinates=[0.1, 0, 0, 0], numberOfDataCoordinates=4)
        )
        contact = system.AddObject(
            items.ObjectContactSphereSphere(
                markerNumbers=[
                    system.AddMarker(items.MarkerBodyRigid(bodyNumber=ground)),
                    system.AddMarker(items.MarkerBodyRigid(bodyNumber=made["bodyNumber"])),
                ],
                nodeNumber=memory,
                spheresRadii=[RADIUS, RADIUS],
                contactStiffness=STIFFNESS,
                restitutionCoefficient=RESTITUTION,
                minimumImpactVelocity=1e-3 * SPEED,
                impactModel=model,
            )
        )
        force = system.AddSensor(
            items.SensorObject(
                objectNumber=contact, storeInternal=True, outputVariableType=exu.OutputVariableType.Force
            )
        )
        velocity = system.AddSensor(
            items.SensorBody(
                bodyNumber=made["bodyNumber"],
                storeInternal=True,
                outputVariableType=exu.OutputVariableType.Velocity,
            )
        )
        system.Assemble()
        settings = exu.SimulationSettings()
        settings.timeIntegration.endTime = DURATION
        settings.timeIntegration.numberOfSteps = round(DURATION / STEP)
        settings.solution.sensors.writePeriod = STEP
        settings.solution.file.write = False
        settings.timeIntegration.verboseMode = 0
        system.SolveDynamic(settings, solverType=exu.DynamicSolverType.TrapezoidalIndex2)
        largest = abs(system.GetSensorStoredData(force)[:, 1:]).max()
        return float(system.GetSensorStoredData(velocity)[-1, 3]) / SPEED, float(largest)

    return found


#: Simulator and way, what it needs, what it makes of a mass, and the law here with the mass.
CASES: tuple[tuple[str, str, Callable[[float], Found], Callable[[float], NormalLaw]], ...] = (
    (
        "MuJoCo, solref direct",
        "mujoco",
        by_mujoco,
        lambda mass: KelvinVoigt(stiffness=mass * STIFFNESS, damping=mass * DAMPING, exponent=1.0),
    ),
    (
        "Drake, point, lagged",
        "pydrake",
        by_drake,
        lambda mass: MarhefkaOrin(stiffness=STIFFNESS, slope=DISSIPATION / 1.5, exponent=1.0),
    ),
    (
        "Exudyn, impact model 1",
        "exudyn",
        by_exudyn(1),
        lambda mass: HuntCrossley(stiffness=STIFFNESS, restitution=RESTITUTION, exponent=1.0),
    ),
    (
        "Exudyn, impact model 2",
        "exudyn",
        by_exudyn(2),
        lambda mass: CarvalhoMartins(stiffness=STIFFNESS, restitution=RESTITUTION, exponent=1.0),
    ),
)


def main() -> None:
    """Print what those that are there make of the impact, and the laws here."""
    print(f"{'':24}{'law here':20}  mass [kg]  left there, here [-]  largest force there, here [N]")
    for name, package, theirs, ours in CASES:
        if importlib.util.find_spec(package) is None:
            print(f"{name:24}is not here: pip install {package.removeprefix('py')}")
            continue
        for mass in MASSES:
            law = ours(mass)
            left, force = theirs(mass)
            here = impact_on_wall(law, mass=mass, speed=SPEED)
            print(
                f"{name:24}{type(law).__name__:20}{mass:11g}{left:11.5f}{here.restitution:11.5f}"
                f"{force:14.3f}{here.peak_force:14.3f}"
            )


if __name__ == "__main__":
    main()
