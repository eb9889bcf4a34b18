"""The joint-contact plugin: geometry + laws + contact memory -> the wrench on a joint with play."""

from antenna_pin._lazy import only_public
from antenna_pin.joints.clearance import ClearanceJoint
from antenna_pin.joints.contacts import JointContacts
from antenna_pin.joints.python_path import LawInRun, PythonPath

__all__ = ["ClearanceJoint", "JointContacts", "LawInRun", "PythonPath"]

only_public(__name__)
