"""What compiled code does in the place of a call by an address: the intrinsics' code, run by LLVM alone."""

import ctypes

import pytest
from llvmlite import binding, ir

from antenna_pin.compiled import intrinsics
from antenna_pin.compiled.calls import CALLED_BACK


def compiled(lowered, address, returns, floats, *more):
    """Return the address of a function whose body a lowering writes, and the engine that holds it."""
    double = ir.DoubleType()
    module = ir.Module("calls")
    function = ir.Function(module, ir.FunctionType(returns, [address, *[double] * floats, *more]), "called")
    builder = ir.IRBuilder(function.append_basic_block())
    builder.ret(lowered(None, builder, None, list(function.args)))
    binding.initialize_native_target()
    binding.initialize_native_asmprinter()
    machine = binding.Target.from_default_triple().create_target_machine()
    engine = binding.create_mcjit_compiler(binding.parse_assembly(str(module)), machine)
    engine.finalize_object()
    return engine.get_function_address("called"), engine


@pytest.mark.parametrize("status", [0, 3, -1])
def test_a_function_in_python_is_called_back_with_a_time_and_its_status_returned(status):
    """``call_back``: a time and an address go in as they are, a whole number comes out."""
    asked = []

    @CALLED_BACK
    def answer(t, target):
        asked.append((t, target))
        return status

    at, engine = compiled(intrinsics._lowered_call_back, ir.IntType(64), ir.IntType(64), 1, ir.IntType(64))
    call = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64, ctypes.c_double, ctypes.c_int64)(at)
    assert call(ctypes.cast(answer, ctypes.c_void_p).value, 0.1, 4096) == status
    assert asked == [(0.1, 4096)]
    engine.close()


@pytest.mark.parametrize("count", [1, 3])
def test_a_function_of_floats_is_called_by_an_address_among_floats(count):
    """``call_1``, ``call_3``: the address stands in a program's numbers, as a float."""
    seen = []

    @ctypes.CFUNCTYPE(*[ctypes.c_double] * (count + 1))
    def law(*numbers):
        seen.append(numbers)
        return sum(numbers) / 3.0

    at, engine = compiled(intrinsics._lowered_call, ir.DoubleType(), ir.DoubleType(), count)
    call = ctypes.CFUNCTYPE(*[ctypes.c_double] * (count + 2))(at)
    numbers = (0.1, -2.5, 7e-9)[:count]
    assert call(float(ctypes.cast(law, ctypes.c_void_p).value), *numbers) == sum(numbers) / 3.0
    assert seen == [numbers]
    engine.close()
