"""Machine: connection, mode, program, positions, alarms; and the operator of the simulated control."""

from __future__ import annotations

from gearmath.control.interface import AXES
from gearmath.hmi import acting, widgets
from gearmath.hmi.messages import Text
from gearmath.hmi.simulated import SimulatedMachine
from gearmath.hmi.state import Shared
from gearmath.hmi.words import connection, duration, facts

_FACTS = ("mode", "channel", "program", "message", "probe")


def build(shared: Shared, text: Text) -> None:
    """The content of the page."""
    with widgets.panel(text("machine.control")):
        said = widgets.Message()
        problem = widgets.note("")
        values = {name: widgets.fact(text(f"machine.{name}")) for name in _FACTS}
    with widgets.panel(text("machine.positions")) as panel:
        stale = widgets.Message()
        axes = [widgets.fact(text("machine.axis", name=name), "–", "°" if name in "AB" else "mm") for name in AXES]
        panel.classes("gm-positions")

    def look() -> None:
        words, kind = connection(text, shared.link)
        said.show(words, kind)
        if shared.link is None:
            return
        view = shared.link.view
        problem.text = "" if view.connected else text.quoted(view.problem)
        for name, found in facts(text, view).items():
            values[name].text = found
        for label, position in zip(axes, view.status.position if view.status else (), strict=False):
            label.text = f"{position:z.3f}"
        old = view.age is not None and view.is_stale
        stale.show(text("machine.stale", age=duration(text, view.age or 0.0)) if old else "", "error")
        panel.classes(add="gm-stale" if old else "", remove="" if old else "gm-stale")

    acting.watch(text, look)
    _alarms(shared, text)
    if shared.simulated is not None:
        _operator(shared, text, shared.simulated)


def _alarms(shared: Shared, text: Text) -> None:
    titles = ("number", "text", "came", "gone", "seen")
    with widgets.panel(text("machine.alarms"), wide=True):
        none = widgets.note(text("machine.no_alarms"))
        rows = widgets.table([(name, text(f"machine.alarm_{name}")) for name in titles], [])
        see = widgets.button(text("machine.see"), lambda: shared.book.see(shown), "visibility")
    shown: list[int] = []

    def look() -> None:
        entries = shared.book.entries()
        shown[:] = [one.number for one in entries]
        found = [
            {
                "id": one.number,
                "number": one.alarm,
                "text": one.text,
                "came": one.came[:19].replace("T", " "),
                "gone": one.gone[:19].replace("T", " ") or text("machine.active"),
                "seen": text("machine.yes" if one.seen else "machine.no"),
            }
            for one in entries[:100]
        ]
        if rows.rows != found:
            rows.rows = found
        none.visible, rows.visible = not found, bool(found)
        see.visible = any(not one.seen for one in entries)

    acting.watch(text, look, 2 * widgets.LOOK)


def _operator(shared: Shared, text: Text, machine: SimulatedMachine) -> None:
    link = shared.link
    assert link is not None
    chosen = {"name": ""}

    def missing() -> str:
        return "" if chosen["name"] else text("machine.select_needed" if names.options else "machine.none_on_control")

    with widgets.panel(text("machine.operator"), wide=True):
        widgets.note(text("machine.operator_note"))
        with acting.buttons() as button:
            names = widgets.choice(
                text("machine.operator_program"),
                machine.programs(),
                None,
                lambda name: chosen.update(name=name or ""),
            )
            button(missing, text("machine.select"), lambda: machine.select(chosen["name"], shared.choice.gear_set))
            widgets.button(text("machine.start"), machine.start, "play_arrow")
            widgets.button(text("machine.reset"), lambda: link.submit(machine.reset()), "restart_alt")
            widgets.button(text("machine.stop"), machine.emergency_stop, "dangerous")
            widgets.button(text("machine.touch_probe"), machine.touch_probe, "touch_app")
            cut = widgets.button(text("machine.cut_line"), lambda: link.submit(machine.cut_line()), "link_off")

    def look() -> None:
        found = machine.programs()
        if names.options != found:
            names.set_options(found, value=chosen["name"] or None)
        cut.enabled = link.view.connected  # what it fails is said above

    acting.watch(text, look)
