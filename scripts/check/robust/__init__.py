"""Checks of robustness, each a subcommand of ``robustness.py``, and what they share."""
