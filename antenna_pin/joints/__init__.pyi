from antenna_pin.joints.clearance import ClearanceJoint as ClearanceJoint
from antenna_pin.joints.clearance import JointContacts as JointContacts
from antenna_pin.joints.python_path import LawInRun as LawInRun
from antenna_pin.joints.python_path import PythonPath as PythonPath
