"""The joint-contact plugin: geometry + laws + contact memory -> the wrench on a joint with play."""

from antenna_pin.joints.clearance import ClearanceJoint, JointContacts

__all__ = ["ClearanceJoint", "JointContacts"]
