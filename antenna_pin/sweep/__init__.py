"""Parameter studies: many runs of a scenario, on the cores at hand or a cluster, in one store."""

from antenna_pin.base.lazy import exported

exported(__name__)
