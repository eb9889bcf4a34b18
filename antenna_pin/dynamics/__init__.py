"""Free-floating equations of motion, joints held by constraint, force elements, audits."""

from antenna_pin._lazy import exported

exported(__name__)
