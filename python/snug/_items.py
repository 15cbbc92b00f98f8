"""Boxes of an order from Python's own tables, for `Scenario.with_items`."""
from __future__ import annotations

import csv
import dataclasses
import io
from typing import Any, Dict, List, Mapping

from ._errors import refused


def _rows(items: Any) -> List[Mapping[str, Any]]:
    if hasattr(items, "to_dict") and hasattr(items, "columns"):  # a DataFrame of pandas
        return list(items.to_dict("records"))
    rows: List[Mapping[str, Any]] = []
    for item in items:
        if dataclasses.is_dataclass(item) and not isinstance(item, type):
            item = dataclasses.asdict(item)
        if not isinstance(item, Mapping):
            raise refused("items", type(item).__name__, "a file, a table of pandas, or a list of dicts or dataclasses")
        rows.append(item)
    return rows


def _cell(value: Any) -> Any:
    if value is None or value != value:  # NaN: how pandas says that there is none
        return ""
    return int(value) if isinstance(value, bool) or type(value).__name__ == "bool_" else value


def as_csv(items: Any) -> str:
    """The table of orders (docs/formats.md, orders) that has a line for each of `items`."""
    rows = _rows(items)
    if not rows:
        raise refused("items", "none", "one box or more")
    columns: Dict[str, None] = {}
    for row in rows:
        columns.update(dict.fromkeys(map(str, row)))
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        writer.writerow([_cell(row.get(column)) for column in columns])
    return table.getvalue()
