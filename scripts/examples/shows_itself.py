"""A result shows itself: figures, a recording, a report and numbers are functions of its own."""

from antenna_pin import load_scenario, simulate

ideal, run = (simulate(load_scenario("bai2020", case=case), duration=0.2) for case in ("case1", "case3"))

forces = run.plot("contact_forces")  # or run.plot.contact_forces(); run.plot.<TAB> lists what this run has
forces.savefig("forces.png")
run.plot("motion_acceleration", beside=ideal, joint="elevation").savefig("acceleration.png")
run.record("run.html", ideal=ideal)  # .png, .mp4 and .gif too, by a browser
run.report("run_report.html", beside=ideal, figures=False, recordings=False)

numbers = run.analyse(ideal)  # what `antenna-pin analyse` says, in plain numbers
print(", ".join(numbers))
print(run.analyse.impacts().sizes["impact"], "impacts")
