"""Where journal and bearing meet and how deep: surfaces, no forces."""

from antenna_pin._lazy import exported

exported(__name__)
