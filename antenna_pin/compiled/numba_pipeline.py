"""Numba's compiler with the passes that kernels need, and cheaper comparisons of its settings.

Kernels have no closures, ``with``, ``raise`` or list, no expression of whole arrays, and no counted
references. The passes that rewrite or optimise these, and the analysis of the function after each, change
nothing. Of a function that is only inlined into others no machine code is generated.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder, Flags
from numba.core.compiler_machinery import PassManager

_NOT_NEEDED = frozenset(
    {
        "WithLifting",
        "InlineClosureLikes",
        "RewriteDynamicRaises",
        "MakeFunctionToJitFunction",
        "InlineInlinables",
        "FindLiterallyCalls",
        "LiteralUnroll",
        "LiteralPropagationSubPipelinePass",
        "NopythonRewrites",
        "DumpParforDiagnostics",
    }
)


class _Library(JITCodeLibrary):  # type: ignore[misc]
    """Code of a kernel, optimised once, after inlining."""

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        made = self._codegen._module_pass_manager()
        passes, *builder = made if isinstance(made, tuple) else (made,)  # alone before Numba 0.62
        passes.run(self._final_module, *builder)


class _InlinedLibrary(_Library):
    """LLVM code of a function that is only inlined; it has no address."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def _get_compiled_object(self) -> bytes:
        return b""

    def get_pointer_to_function(self, name: str) -> int:
        """Return zero, the address of no function."""
        self._ensure_finalized()
        return 0

    @property
    def codegen(self) -> _WithoutEnvironments:
        """Numba's code generator."""
        return _WithoutEnvironments(self._codegen)


class _WithoutEnvironments:
    """Code generator for code without an address: it has no place for an environment."""

    def __init__(self, codegen: Any) -> None:
        self._codegen = codegen

    def __getattr__(self, name: str) -> Any:
        return getattr(self._codegen, name)

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing: callers set it in their code."""


class KernelCompiler(CompilerBase):  # type: ignore[misc]
    """Numba's pipeline for compiled functions without the passes that kernels do not need."""

    def define_pipelines(self) -> list[PassManager]:
        """Return the pipeline; branches that a constant rules out are removed once, in SSA form."""
        state = self.state
        if state.library is None:
            made = _InlinedLibrary if state.flags.forceinline and state.flags.no_cpython_wrapper else _Library
            state.library = made(state.targetctx.codegen(), state.func_id.func_qualname)
            state.library.enable_object_caching()
        whole = DefaultPassBuilder.define_nopython_pipeline(self.state)
        kept = PassManager("kernel")
        for number, (made, text) in enumerate(whole.passes):
            comes_again = any(made is later for later, _ in whole.passes[number + 1 :])
            if made.__name__ not in _NOT_NEEDED and not comes_again:
                kept.add_pass(made, text)
        kept.finalize()
        return [kept]


@cache
def compare_settings_fast() -> None:
    """Accelerate the comparison of Numba's compiler settings.

    Numba compares all values some hundreds of times for each function, once for each overload that it
    considers. Settings with the same explicit values are equal.
    """
    equal, same = Flags.__eq__, hash(Flags())

    def are_equal(one: Any, other: Any) -> Any:
        return (
            one is other or (type(one) is type(other) and one._values == other._values) or equal(one, other)
        )

    Flags.__eq__ = are_equal
    other = Flags()
    other.nrt = not other.nrt
    if hash(other) == same:  # Numba's is over the names of settings only
        Flags.__hash__ = lambda _: same
