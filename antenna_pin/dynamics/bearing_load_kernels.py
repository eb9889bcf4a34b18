"""Loads of bearings at the samples of a run, compiled."""

from __future__ import annotations

from numpy.typing import NDArray

from antenna_pin.base.records import Floats, Ints, Pose, Record, Records, Vector3, layout
from antenna_pin.compiled.decorators import kernel
from antenna_pin.dynamics.kernels import PARAMETERS, element_at, head_of
from antenna_pin.elements import kernels as elements
from antenna_pin.joints.layout_kernels import joint_at
from antenna_pin.joints.pose_kernels import journal_place, journal_state


class BearingLoad(Record):
    """A bearing at a sample, in bearing axes."""

    place: Vector3  # position of the journal at the reference point [m]
    tilt: Vector3  # tilt of the journal's axis; its length is the sine
    force: Vector3  # force on the journal [N]
    moment: Vector3  # moment on it about the reference point [N m]


BEARING_LOAD = layout(BearingLoad)


@kernel
def look_at_bearings(
    program: Floats, states: Floats, blocks: Ints, poses: Records[Pose], out: NDArray[BearingLoad]
) -> None:
    """Write the loads of bearings in states, ``BEARING_LOAD``, (n, blocks).

    Args:
        program: Program of all force elements.
        states: (n, nq + nv + nx).
        blocks: Places of the bearings in the program.
        poses: Written: POSE, (1,).
        out: Written.
    """
    nq = head_of(program).nq
    pose = poses[0]
    for i in range(states.shape[0]):
        for k in range(blocks.shape[0]):
            b, own = blocks[k], out[i, k]
            e = element_at(program, b)
            j = joint_at(program, e.play)
            journal_state(j, states[i], nq, pose)
            elements.press(e.kind, program, b + PARAMETERS, pose)
            f = pose.force
            place = journal_place(j, states[i])
            x, y, z, tx, ty, s = elements.coordinates(e.kind, program, b + PARAMETERS, place)
            own.place[0], own.place[1], own.place[2] = x, y, z
            own.tilt[0], own.tilt[1], own.tilt[2] = tx, ty, 0.0
            for m in range(3):
                own.force[m] = e.on * f[m]
            # From the journal's centre to its point at the reference point.
            sx, sy, sz = s * pose.axis[0], s * pose.axis[1], s * pose.axis[2]
            own.moment[0] = e.on * (pose.moment[0] - (sy * f[2] - sz * f[1]))
            own.moment[1] = e.on * (pose.moment[1] - (sz * f[0] - sx * f[2]))
            own.moment[2] = e.on * (pose.moment[2] - (sx * f[1] - sy * f[0]))
