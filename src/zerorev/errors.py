"""What can go wrong, as data: one base class, few subclasses, each carries its evidence.

What is wrong with one hole of many is not an exception but a `zerorev.model.plan.Finding`.
"""

from __future__ import annotations

from zerorev.visible import visible

__all__ = ["InputError", "NotExportableError", "OutputError", "ZerorevError"]


class ZerorevError(Exception):
    """Base of every error that zerorev raises on purpose; its text is one clear message for a user."""


class InputError(ZerorevError):
    """An input that cannot be used.

    Attributes:
        what: what is wrong, in one sentence.
        where: file, line or field, hole id.
        accepted: what would be accepted instead, or an empty string.
    """

    def __init__(self, what: str, *, where: str = "", accepted: str = "") -> None:
        self.what, self.where, self.accepted = what, where, accepted
        text = f"{where}: {what}" if where else what
        super().__init__(visible(f"{text} (accepted: {accepted})" if accepted else text))


class OutputError(ZerorevError):
    """A file or a folder that cannot be written; what was there before is as it was.

    Attributes:
        path: the file that was asked for.
        why: what the system said.
    """

    def __init__(self, path: str, why: str) -> None:
        self.path, self.why = path, why
        super().__init__(visible(f"cannot write {path}: {why}; what was there is unchanged"))


class NotExportableError(ZerorevError):
    """A plan that must not become a program, with the reasons.

    Attributes:
        reasons: one sentence a reason, each naming its hole.
    """

    def __init__(self, reasons: tuple[str, ...]) -> None:
        self.reasons = reasons
        super().__init__(visible("not exported, because\n" + "\n".join(f"  - {reason}" for reason in reasons)))
