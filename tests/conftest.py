"""What all tests share."""

from hypothesis import settings

# The same examples in every run, and no deadline, because a first example may compile kernels.
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")
