"""One-file reports on any number of runs, to be read on a screen, a phone or paper."""

from antenna_pin._lazy import only_public
from antenna_pin.report.document import Report, report
from antenna_pin.report.provenance import report_command, run_command
from antenna_pin.report.study import study_report

__all__ = ["Report", "report", "report_command", "run_command", "study_report"]

only_public(__name__)
