"""Free-floating equations of motion, joints held by constraint, force elements, audits."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.dynamics.acting import acting_in, check_begins
    from antenna_pin.dynamics.actuators import actuators_of, settled
    from antenna_pin.dynamics.adjust import (
        Adjustments,
        first_modes,
        joints_held,
        modes_in_another,
        modes_kept,
    )
    from antenna_pin.dynamics.assembly import (
        BASE,
        assemble,
        assembled,
        check_closed,
        check_motions,
    )
    from antenna_pin.dynamics.attitudes import journal_attitudes
    from antenna_pin.dynamics.audit import Audit, audit
    from antenna_pin.dynamics.bearing_loads import bearing_loads, bearing_names
    from antenna_pin.dynamics.counts import constraint_counts, mobility_of
    from antenna_pin.dynamics.coupled import facts_of_couplings, put_followers
    from antenna_pin.dynamics.deflection import Deflections, deflections
    from antenna_pin.dynamics.evaluate import acceleration, contact_memory
    from antenna_pin.dynamics.held import HeldKind
    from antenna_pin.dynamics.impulse import Push, apart, impulse, push_apart, reduced_inertia
    from antenna_pin.dynamics.links import acting_on_links, works_in_x
    from antenna_pin.dynamics.motion import JointMotion, motion_block
    from antenna_pin.dynamics.program_parts import records_at
    from antenna_pin.dynamics.restraints import (
        NotFollowedError,
        check_restraint,
        check_restraints,
        is_rigid,
        prescribing,
    )
    from antenna_pin.dynamics.samples import Observed, joint_motion, observed, sliding_motion
    from antenna_pin.dynamics.system import System
    from antenna_pin.dynamics.workspace import Workspace
    from antenna_pin.elements import (
        CallableDrive,
        ConstantDrive,
        Drive,
        JointFriction,
        JointSpring,
        PointSpring,
        SineDrive,
        TableDrive,
    )

__all__ = [
    "actuators_of",
    "settled",
    "BASE",
    "Adjustments",
    "first_modes",
    "modes_in_another",
    "modes_kept",
    "Push",
    "apart",
    "impulse",
    "push_apart",
    "reduced_inertia",
    "joints_held",
    "Audit",
    "CallableDrive",
    "ConstantDrive",
    "Deflections",
    "Drive",
    "HeldKind",
    "JointMotion",
    "JointFriction",
    "JointSpring",
    "NotFollowedError",
    "Observed",
    "PointSpring",
    "SineDrive",
    "System",
    "TableDrive",
    "Workspace",
    "acceleration",
    "acting_in",
    "acting_on_links",
    "assemble",
    "assembled",
    "audit",
    "check_begins",
    "bearing_loads",
    "bearing_names",
    "check_closed",
    "check_motions",
    "check_restraint",
    "check_restraints",
    "is_rigid",
    "contact_memory",
    "deflections",
    "facts_of_couplings",
    "joint_motion",
    "motion_block",
    "journal_attitudes",
    "constraint_counts",
    "mobility_of",
    "observed",
    "put_followers",
    "prescribing",
    "records_at",
    "sliding_motion",
    "works_in_x",
]

loaded_when_used(
    __name__,
    {
        "acting": "acting_in check_begins",
        "actuators": "actuators_of settled",
        "adjust": "Adjustments first_modes joints_held modes_in_another modes_kept",
        "assembly": "BASE assemble assembled check_closed check_motions",
        "counts": "constraint_counts mobility_of",
        "attitudes": "journal_attitudes",
        "audit": "Audit audit",
        "bearing_loads": "bearing_loads bearing_names",
        "coupled": "facts_of_couplings put_followers",
        "deflection": "Deflections deflections",
        "evaluate": "acceleration contact_memory",
        "held": "HeldKind",
        "impulse": "Push apart impulse push_apart reduced_inertia",
        "links": "acting_on_links works_in_x",
        "motion": "JointMotion motion_block",
        "program_parts": "records_at",
        "restraints": "NotFollowedError check_restraint check_restraints is_rigid prescribing",
        "samples": "Observed joint_motion observed sliding_motion",
        "system": "System",
        "workspace": "Workspace",
        "antenna_pin.elements": "CallableDrive ConstantDrive Drive JointFriction JointSpring PointSpring "
        "SineDrive TableDrive",
    },
)
