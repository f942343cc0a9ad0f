"""The pages, in the order of the work. Each is a module with ``build(shared, text)``."""

from __future__ import annotations

#: Name (of the module, the address and the table of messages) and Material icon.
PAGES = {
    "machine": "precision_manufacturing",
    "gear": "settings",
    "programs": "description",
    "measure": "my_location",
    "result": "insights",
    "correct": "tune",
    "history": "history",
    "gearbox": "sync_alt",
}
