"""Ownership of files: code is loaded from closed folders only.

The rule is that of ssh for its keys: every folder of the path belongs to a trusted user and is not writable
for others; a sticky folder like ``/tmp``, in which only owners may move files, is permitted in the path.
"""

from __future__ import annotations

import grp
import os
import pwd
import stat
from functools import lru_cache
from pathlib import Path


def stranger_of(folder: str | os.PathLike[str], trusted: int) -> str | None:
    """Return, as text, a further user with write access to a folder; None without one.

    Args:
        folder: Existing folder.
        trusted: Number of a trusted user besides root and the present one, as the owner of the sources.

    Raises:
        OSError: The folder cannot be examined.
    """
    whole = Path(folder).resolve(strict=True)
    for at in (whole, *whole.parents):
        found = open_to(at.stat(), trusted, sticky=at != whole)
        if found:
            return f"{at} {found}"
    return None


def open_to(about: os.stat_result, trusted: int, *, sticky: bool = False) -> str | None:
    """Return, as text, a further user with write access by a ``stat``; None without one.

    Args:
        about: Result of ``stat`` of a file or folder.
        trusted: As for :func:`stranger_of`.
        sticky: Whether a folder in which only owners may move files counts as closed.
    """
    if about.st_uid not in (0, os.geteuid(), trusted):
        return f"belongs to {_user(about.st_uid)}"
    if sticky and about.st_mode & stat.S_ISVTX:
        return None
    if about.st_mode & stat.S_IWOTH:
        return "may be written by everybody"
    if about.st_mode & stat.S_IWGRP and not _alone_in(about.st_gid, about.st_uid):
        return f"may be written by the group {_group(about.st_gid)}"
    return None


@lru_cache
def _alone_in(group: int, user: int) -> bool:
    """Return whether a group is a user's own, as on many systems."""
    if group == 0:
        return True
    try:
        return grp.getgrgid(group).gr_mem in ([], [pwd.getpwuid(user).pw_name]) and not any(
            one.pw_gid == group and one.pw_uid != user for one in pwd.getpwall()
        )
    except KeyError:
        return False


def _user(number: int) -> str:
    try:
        return pwd.getpwuid(number).pw_name
    except KeyError:
        return f"user {number}"


def _group(number: int) -> str:
    try:
        return grp.getgrgid(number).gr_name
    except KeyError:
        return str(number)
