"""Scenarios by file or by name: those that come with snug are in share/ of this package."""
from __future__ import annotations

import os
from pathlib import Path
from typing import List, Union

from . import _core

_SHIPPED = Path(__file__).with_name("share") / "snug" / "scenarios"


def load_scenario(path: Union[str, "os.PathLike[str]"]) -> _core.Scenario:
    """Reads a scenario: a file, or the name of one that comes with snug (`scenario_names()`), such as "box-demonstrator".

    A file of that name in the current folder, with or without ".yaml", comes first.

    Raises InputError with file, line and key, and for an unknown name with the nearest one.
    """
    return _core.load_scenario(os.fspath(path), _SHIPPED)


def scenario_names() -> List[str]:
    """Names of the scenarios that come with snug."""
    return _core.list_scenarios(_SHIPPED)
