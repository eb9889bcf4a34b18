"""What a run shows, and what a joint's shape allows: readers of trajectories and geometries."""

from antenna_pin._lazy import exported

exported(__name__)
