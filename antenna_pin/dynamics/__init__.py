"""Free-floating equations of motion, joints held by constraint, force elements, audits."""

from antenna_pin.base.lazy import exported

exported(__name__)
