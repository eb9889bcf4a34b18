from antenna_pin.show.report.document import Report as Report
from antenna_pin.show.report.document import report as report
from antenna_pin.show.report.provenance import report_command as report_command
from antenna_pin.show.report.provenance import run_command as run_command
from antenna_pin.show.report.study import study_report as study_report
from antenna_pin.show.report.verification import verification_report as verification_report
