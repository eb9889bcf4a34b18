"""Build hook of wheels: the shim to Pinocchio's and coal's machine code, where it is asked for.

A plain wheel is for all platforms and holds the shim's sources only. With ``ANTENNA_PIN_BUILD_NATIVE=1`` the
wheel is for this platform and holds the shim, compiled against the Pinocchio and coal that the build
environment gets; with others at run time it is not used.
"""

from __future__ import annotations

import os
import runpy
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

_NEEDED = ["pin>=4.0,<5", "coal>=3.0.3,<4", "cmeel-eigen>=3.4"]


class NativeBuildHook(BuildHookInterface):
    """Hook that compiles the shim into a wheel."""

    @property
    def _wanted(self) -> bool:
        wanted = os.environ.get("ANTENNA_PIN_BUILD_NATIVE", "")
        if wanted not in ("", "0", "1"):
            raise SystemExit(f"environment: ANTENNA_PIN_BUILD_NATIVE must be 0 or 1, got {wanted!r}")
        return wanted == "1" and self.target_name == "wheel"

    def dependencies(self) -> list[str]:
        """Return what the build environment needs beside the backend."""
        return _NEEDED if self._wanted else []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile the shim and have it included."""
        if not self._wanted or version == "editable":
            return
        root = Path(self.root)
        builder = runpy.run_path(str(root / "antenna_pin" / "compiled" / "native_build.py"))
        target = root / "build" / "native" / builder["NAME"]
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            self.app.display_info(builder["build"](target, root / "antenna_pin" / "native"))
        except builder["NativeBuildError"] as error:
            raise SystemExit(str(error)) from None
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{platform}"
        build_data["force_include"][str(target)] = f"antenna_pin/native/{builder['NAME']}"
