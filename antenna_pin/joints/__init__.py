"""The joint-contact plugin: geometry + laws + contact memory -> the wrench on a joint with play."""

from typing import TYPE_CHECKING

from antenna_pin._lazy import loaded_when_used

if TYPE_CHECKING:
    from antenna_pin.joints.clearance import ClearanceJoint
    from antenna_pin.joints.contacts import JointContacts
    from antenna_pin.joints.python_path import LawInRun, PythonPath

__all__ = ["ClearanceJoint", "JointContacts", "LawInRun", "PythonPath"]

loaded_when_used(
    __name__,
    {
        "clearance": "ClearanceJoint",
        "contacts": "JointContacts",
        "python_path": "LawInRun PythonPath",
    },
)
