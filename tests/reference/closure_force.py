"""Forces of closures, from the axes of their first side to those of the world."""

from scipy.spatial.transform import Rotation

from antenna_pin.analysis import body_poses, closures_of


def force_of_closure(run, name):
    """Force of a closure on its second link [N], from the axes of the first side to those of the world."""
    side = closures_of(run)[name]
    turn = Rotation.from_quat(side["first_placement"][3:])
    if side["first_body"] != "world":
        link = body_poses(run)["attitude"].sel(body=side["first_body"]).values
        turn = Rotation.from_quat(link) * turn
    return turn.apply(run.data["closure_force"].sel(closure=name).values)
