"""Value classes of a room of the package: what is lacking of what all of them have."""

import dataclasses
import importlib
import inspect
import pkgutil


def lacking(room: str) -> dict[str, set[str]]:
    """Return what dataclasses of a room lack that may be changed, extended or filled by position."""
    package, found = importlib.import_module(f"antenna_pin.{room}"), {}
    modules = [
        importlib.import_module(f"{package.__name__}.{one.name}")
        for one in pkgutil.iter_modules(package.__path__)
    ]
    classes = {
        one
        for module in modules
        for one in vars(module).values()
        if inspect.isclass(one) and dataclasses.is_dataclass(one) and one.__module__ == module.__name__
    }
    assert classes, room
    for one in classes:
        own = {
            "frozen": one.__dataclass_params__.frozen,
            "slots": "__slots__" in vars(one),
            "kw_only": all(field.kw_only for field in dataclasses.fields(one) if field.init),
        }
        if lacks := {name for name, has in own.items() if not has}:
            found[one.__name__] = lacks
    return found
