"""The fit of scripts/bench/fit_coverage.py, for tests."""

import importlib.util
from pathlib import Path

_FILE = Path(__file__).resolve().parents[2] / "scripts" / "bench" / "fit_coverage.py"
_SPEC = importlib.util.spec_from_file_location("fit_coverage", _FILE)
_COVERAGE = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(_COVERAGE)

FIT, TIMES, TRUTH, write_record = (
    getattr(_COVERAGE, name) for name in ("FIT", "TIMES", "TRUTH", "write_record")
)
