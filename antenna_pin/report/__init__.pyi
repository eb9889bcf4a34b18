from antenna_pin.report.document import Report as Report
from antenna_pin.report.document import report as report
from antenna_pin.report.provenance import report_command as report_command
from antenna_pin.report.provenance import run_command as run_command
from antenna_pin.report.study import study_report as study_report
