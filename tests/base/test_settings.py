"""Settings of a run: what is refused beside its span, and the tolerance that an accuracy chooses."""

import pytest

from antenna_pin.base.settings import RunSettings, choice_for
from antenna_pin.errors import InvalidParameterError


@pytest.mark.parametrize(
    ("settings", "begin", "end", "said"),
    [
        ({}, 0.0, 1e-15, "RunSettings: duration must be finite and 1e-13 s or more, from t = 0 s on"),
        ({}, 5.0, 5.0, "RunSettings: duration must be finite and "),
        ({}, 0.0, float("inf"), "RunSettings: duration must be finite and "),
        ({}, 1e6, 1e6 + 1e-8, "duration must be finite and 1.16e-07 s or more, from t = 1e+06 s on"),
        ({"max_step": 1e-10}, 0.0, 10.0, "RunSettings: max_step must be 1e-08 s or more in a run of 10 s"),
        ({"max_step": 1e-10}, 0.0, 10.0, "for integrator.max_expected_steps, got 1e-10 s"),
        ({"method": "rk4", "step": 1e-10}, 0.0, 10.0, "RunSettings: step must be 1e-08 s or more"),
        ({"max_step": 1e-12, "max_steps": 5}, 1e5, 1e5 + 1.0, "s or more in a run of 1 s, for round-off of "),
        ({"output_times": (1.0, 3.0)}, 0.0, 2.0, "output_times must be at most 2 s, the end of the run"),
        ({"output_rate": 1e15}, 0.0, 2.0, "RunSettings: output_rate must be "),
    ],
)
def test_steps_and_samples_that_no_run_can_have_are_refused(settings, begin, end, said):
    with pytest.raises(InvalidParameterError) as refused:
        RunSettings(**settings).check_span(begin, end)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_span_of_some_steps_is_taken_and_limits_of_steps_go_before_the_expected_ones():
    RunSettings().check_span(0.0, 1e-13)
    RunSettings(max_step=1e-10, max_steps=5).check_span(0.0, 10.0)
    RunSettings(output_times=(1.0, 2.0)).check_span(0.0, 2.0)


def test_a_higher_accuracy_takes_a_smaller_tolerance():
    """Never a looser one than for a lower accuracy, and the order of the method changes once."""
    accuracies = [10.0 ** (-0.25 * k) for k in range(4, 41)]
    methods, tolerances = zip(*map(choice_for, accuracies), strict=True)
    assert list(tolerances) == sorted(tolerances, reverse=True)
    assert len(set(tolerances)) > 30 and tolerances[0] <= 1e-3
    assert sorted(methods) == list(methods) and len(set(methods)) == 2
