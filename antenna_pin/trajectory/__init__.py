"""Results of runs: labelled arrays by a schema, outcome and files."""

from antenna_pin.base.lazy import exported

exported(__name__)
