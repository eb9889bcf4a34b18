"""What a run shows, and what a joint's shape allows: readers of trajectories and geometries."""

from antenna_pin.base.lazy import exported

exported(__name__)
