from antenna_pin.fmu.export import export_fmu as export_fmu
