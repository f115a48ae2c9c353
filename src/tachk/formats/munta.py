"""Models for Munta, whose checker is verified: the plug-in tachk-munta writes them."""

from __future__ import annotations

from tachk.base.plugins import separate_plugin
from tachk.formats.exported import Exported, Writing
from tachk.frontend.loaded import LoadedModel


def export_munta(model: LoadedModel, writing: Writing) -> Exported:
    """Raises UsageError where the plug-in is not installed."""
    return Exported(separate_plugin("munta export")(model.network, model.queries))
