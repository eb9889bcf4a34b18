"""Parameter studies: many runs of a scenario, local or on a cluster, in one store."""

from antenna_pin.base.lazy import exported

exported(__name__)
