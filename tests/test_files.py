"""Files are complete or as they were, whatever ends the writing."""

import re

import pytest

from antenna_pin.errors import OutputError
from antenna_pin.files import replacing


def test_what_was_written_becomes_the_file(tmp_path):
    target = tmp_path / "result.txt"
    target.write_text("old")
    with replacing(target) as partial:
        partial.write_text("new")
        assert target.read_text() == "old"
    assert target.read_text() == "new"
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("reason", [KeyboardInterrupt, ValueError, OutputError("other.txt: is full")])
def test_what_ends_the_writing_leaves_the_file_as_it_was(tmp_path, reason):
    """Nothing stays beside it, and the reason is passed on: an error of another file keeps its words."""
    target = tmp_path / "result.txt"
    target.write_text("old")
    expected = reason if isinstance(reason, type) else type(reason)
    with pytest.raises(expected) as ended, replacing(target) as partial:
        partial.write_text("half of")
        raise reason
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]
    assert isinstance(reason, type) or str(ended.value) == "other.txt: is full"


def test_what_cannot_be_written_is_said_in_one_line(tmp_path):
    target = tmp_path / "missing" / "result.txt"
    message = rf"^{re.escape(str(target))}: cannot be written: No such file or directory$"
    with pytest.raises(OutputError, match=message), replacing(target) as partial:
        partial.write_text("new")
